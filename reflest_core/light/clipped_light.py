# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where clipped light may be stronger than what was recorded, and in which channel."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.light.light_map import ObservedLight

PARTLY = 0.05
"""Radiance beyond white where one or two channels were clipped, in units of that where all three
were: in backgrounds of SynBRDF's training scenes 0.1 to 0.9 against 9 to 12 of it, in the mean.
A blue sky leaves the range a little, in one channel; a lamp in all three, and far."""


def excess_shape(light: ObservedLight) -> NDArray[np.float32]:
    """(N, N, 3): what clipped light may hold beyond white in each channel, up to a common factor.

    1 where all of a texel was clipped in all channels, 0 in a channel that was never clipped.
    """
    red, green, blue = np.moveaxis(light.clipped, -1, 0)
    in_all = np.minimum(np.minimum(red, green), blue)[..., None]
    shape = in_all + np.float32(PARTLY) * (light.clipped - in_all)
    return np.asarray(shape * light.coverage[..., None])
