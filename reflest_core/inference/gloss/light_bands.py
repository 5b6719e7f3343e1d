# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where in the light a change of roughness shows: differences of its blurred versions.

A highlight of roughness ``alpha`` is the light blurred by the lobe. Its derivative by ``ln alpha``
is the difference of two blurs, a band-pass of the light. One look-up of each band in the mirrored
direction predicts how much an observation says about roughness.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from reflest_core.light.completion import RADIANCE, LightPyramid, doubled, halved

BANDS = 3
"""Between levels of the pyramid: roughnesses of about .02, .05 and .1 with texels of 2 degrees."""
USUAL_EXCESS = 4.0
"""Radiance of a lamp above white, in units of white, where the camera clipped it."""
TRUST = 3.0
"""Power of the share of a lobe's light that was seen, by which its observation counts."""


def light_bands(light: LightPyramid) -> NDArray[np.float32]:
    """Return what each direction of the light says about roughness.

    Args:
        light: The completed light; its finest level has edge N.

    Returns:
        (N * N, 3 * BANDS + 1): derivatives of the reflected radiance at ``rho_s = 1`` by
        ``ln alpha``, three channels for each band, then how far the light there is to be trusted,
        in [0, 1].
    """
    levels = light.levels[: BANDS + 1]
    size = len(levels[0])
    excess = light.excess
    blurred = []
    for level in levels:
        bright = level[..., RADIANCE] + np.float32(USUAL_EXCESS) * excess
        blurred.append(_at_size(np.concatenate([bright, level[..., 3:4]], axis=-1), size))
        excess = halved(excess)
    bands = [
        (fine[..., RADIANCE] - coarse[..., RADIANCE]) / np.float32(math.log(2.0))
        for fine, coarse in pairwise(blurred)
    ]
    trust = np.clip(blurred[-2][..., 3:], 0.0, 1.0) ** np.float32(TRUST)
    return np.concatenate([*bands, trust], axis=-1).reshape(size * size, -1).astype(np.float32)


def _at_size(image: NDArray[np.float32], size: int) -> NDArray[np.float32]:
    while len(image) < size:
        image = doubled(image)
    return image
