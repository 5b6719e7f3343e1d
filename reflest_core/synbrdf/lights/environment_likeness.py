# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Whether two environments are one photograph under two names, perhaps turned about the vertical.

Collections share their sources, and rename them: what is called ``sunrise`` in one is
``spruit_sunrise`` in another. An unseen split is only unseen if none slips into training.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import LUMINANCE_WEIGHTS

SAME = 0.95
"""Likeness of one photograph, resampled and turned; of two the greatest that was seen is 0.71."""
DARKEST = 0.01
"""Of the median luminance: what is darker counts as this dark."""


def likeness(one: NDArray[np.float32], other: NDArray[np.float32]) -> float:
    """Correlate the log luminances of two maps, less each row's mean, at the best turn.

    Args:
        one: (H, 2 H, 3) linear radiance, equirectangular.
        other: (H, 2 H, 3) linear radiance, equirectangular.

    Returns:
        -1 to 1, whatever the brightness; 0 where one map is constant along its rows.
    """
    a, b = _pattern(one), _pattern(other)
    length = float(np.sqrt((a**2).sum() * (b**2).sum()))
    if length == 0.0:
        return 0.0
    spectrum = (np.fft.rfft(a, axis=1) * np.fft.rfft(b, axis=1).conj()).sum(axis=0)
    return float(np.fft.irfft(spectrum, n=a.shape[1]).max() / length)


def _pattern(radiance: NDArray[np.float32]) -> NDArray[np.float64]:
    luminance = (radiance * LUMINANCE_WEIGHTS).sum(axis=-1, dtype=np.float64)
    middle = float(np.median(luminance)) or 1.0
    logs = np.log(luminance / middle + DARKEST)
    pattern = logs - logs.mean(axis=1, keepdims=True)
    return np.asarray(np.where(np.abs(pattern) < 1e-9, 0.0, pattern))
