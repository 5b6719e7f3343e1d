# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""By how much colours and predicted highlights may be wrong."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb

ENCODED, RELATIVE = 0.009, 0.012
"""Standard deviation of an observed colour: in sRGB values of [0, 1], and as a share of the linear
colour. Together they hold sensor noise, rounding and a voxel's extent in the image."""
HIGHLIGHT_ERROR = 0.1
"""Share of a predicted highlight by which it may be wrong."""


@cache
def colour_variances() -> NDArray[np.float64]:
    """Return the variance (256,) of the linear light of each 8-bit sRGB value."""
    encoded = np.arange(256) / 255.0
    slope = np.where(
        encoded <= 0.04045, 1 / 12.92, 2.4 / 1.055 * ((encoded + 0.055) / 1.055) ** 1.4
    )
    return np.asarray((ENCODED * slope) ** 2 + (RELATIVE * srgb.LINEAR.astype(np.float64)) ** 2)
