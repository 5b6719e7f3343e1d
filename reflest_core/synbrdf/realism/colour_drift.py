# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Exposure and white balance that wander from view to view, as a camera's automatics do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.synbrdf.scenes.views import smooth_noise

WANDER_RMS = 0.49
"""Of :func:`smooth_noise`."""
MOST_STOPS = 2.0
"""Auto exposure and wander together stay within this of the scene's exposure."""


def draw_view_gains(
    realism: Realism, metered: NDArray[np.float64], streams: dict[Effect, np.random.Generator]
) -> NDArray[np.float32]:
    """Draw factors on the scene's exposure for each view's red, green and blue.

    Args:
        realism: which faults, and how strong.
        metered: (W,) mean luminance of each view, in the order in which they were taken.
        streams: random numbers of each fault.

    Returns:
        (W, 3) factors.
    """
    views = len(metered)
    stops = _exposure_stops(realism, metered, streams[Effect.EXPOSURE])
    rng = streams[Effect.WHITE_BALANCE]
    degree = realism.white_balance * rng.uniform()
    wander = smooth_noise(rng, views, 2) / WANDER_RMS
    gains = np.ones((views, 3))
    gains[:, [0, 2]] = np.exp(degree * wander)
    return (gains * np.exp2(stops)[:, None]).astype(np.float32)


def _exposure_stops(
    realism: Realism, metered: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    degree, share = realism.exposure_stops * rng.uniform(), realism.metering * rng.uniform()
    brightness = np.log2(np.maximum(metered, 1e-12))
    made_up = share * (brightness.mean() - brightness)
    wander = degree * smooth_noise(rng, len(metered)) / WANDER_RMS
    return np.asarray(np.clip(made_up + wander, -MOST_STOPS, MOST_STOPS))
