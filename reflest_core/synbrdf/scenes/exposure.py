# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Auto exposure locked for a scene, and the camera's 8-bit sRGB response."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.brdf.lab import luminance
from reflest_core.errors import ReflestError

MIDDLE_GREY = 0.18


class SceneTooDark(ReflestError):
    """There is no light to expose for."""


def auto_exposure(radiance: NDArray[np.float32], clipped_share: float = 0.1) -> float:
    """Choose the factor from linear radiance to the sensor's [0, 1].

    The geometric mean of the luminance becomes middle grey, unless too many pixels would then pass
    1; in that case exactly ``clipped_share`` of them do.

    Args:
        radiance: (..., 3) linear sRGB.
        clipped_share: most pixels above white.
    """
    light = luminance(np.asarray(radiance, dtype=np.float64).reshape(-1, 3))
    brightest = float(np.quantile(light, 1.0 - clipped_share))
    if not brightest > 0.0:
        raise SceneTooDark("the scene has no light: choose an environment that is not black")
    floor = 1e-3 * brightest
    average = float(np.exp(np.log(np.maximum(light, floor)).mean()))
    return min(MIDDLE_GREY / average, 1.0 / brightest)


def expose(radiance: NDArray[np.float32], exposure: float) -> NDArray[np.uint8]:
    """Return 8-bit sRGB of linear radiance (..., 3): scaled, clipped, encoded, rounded.

    Args:
        radiance: linear radiance.
        exposure: factor from radiance to the sensor's white.
    """
    encoded = srgb.encode(np.asarray(radiance, dtype=np.float32) * np.float32(exposure))
    return np.asarray(np.rint(encoded * 255.0), dtype=np.uint8)
