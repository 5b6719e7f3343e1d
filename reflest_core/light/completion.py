# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Completion of a partial environment: unseen directions take the mean of what lies around them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import kernel_array, vectorised
from reflest_core.light.light_map import ObservedLight
from reflest_core.light.octahedral import octahedral_solid_angles

TRUSTED_SHARE = 0.3
"""A texel of a coarser level of which this much was seen needs no help of the next."""
RADIANCE, SEEN, CLIPPED = slice(0, 3), 3, 4
"""Channels of a :class:`LightPyramid`'s levels, and of what is averaged over them."""
PARTLY = 0.05
"""Radiance beyond white where one or two channels were clipped, in units of that where all three
were: in backgrounds of SynBRDF's training scenes 0.1 to 0.9 against 9 to 12 of it, in the mean.
A blue sky leaves the range a little, in one channel; a lamp in all three, and far."""


@dataclass(frozen=True)
class LightPyramid:
    """The completed light at halving resolutions.

    Attributes:
        levels: Octahedral maps (N, N, 5), (N / 2, N / 2, 5) and so on, float32: linear radiance
            (3), share that was seen, share that was seen clipped (all channels' mean of
            ``excess``).
        excess: (N, N, 3) float32 at the finest resolution, see :func:`excess_shape`.
    """

    levels: list[NDArray[np.float32]]
    excess: NDArray[np.float32]


def complete(light: ObservedLight) -> LightPyramid:
    """Fill by pull and push (Gortler et al. 1996, Sec. 3.4), weighted by solid angle.

    Args:
        light: What was seen.

    Returns:
        The completed light.
    """
    pulled = [np.concatenate([light.radiance, np.ones_like(light.coverage)[..., None]], axis=-1)]
    pulled[0] = pulled[0] * light.coverage[..., None]
    while len(pulled[-1]) % 2 == 0:
        pulled.append(halved(pulled[-1]))
    coarsest = pulled[-1]
    total = np.maximum(coarsest[..., SEEN:].sum(axis=(0, 1)), 1e-9)
    filled = np.broadcast_to(
        coarsest[..., RADIANCE].sum(axis=(0, 1)) / total, (*coarsest.shape[:2], 3)
    )
    for level in reversed(pulled):
        if len(level) > len(filled):
            filled = doubled(filled)
        trust = np.minimum(level[..., SEEN:] / TRUSTED_SHARE, 1.0)
        seen = level[..., RADIANCE] / np.maximum(level[..., SEEN:], 1e-9)
        filled = trust * seen + (1.0 - trust) * filled
    excess = excess_shape(light)
    red, green, blue = np.moveaxis(excess, -1, 0)
    stacked = np.concatenate(
        [filled, np.stack([light.coverage, (red + green + blue) / 3.0], axis=-1)], axis=-1
    ).astype(np.float32)
    return levels_below(stacked, excess)


def excess_shape(light: ObservedLight) -> NDArray[np.float32]:
    """Return how clipped light beyond white may be shared among channels, up to a common factor.

    Args:
        light: What was seen.

    Returns:
        (N, N, 3): 1 where all of a texel was clipped in all channels, 0 in a channel that never
        was.
    """
    red, green, blue = np.moveaxis(light.clipped, -1, 0)
    in_all = np.minimum(np.minimum(red, green), blue)[..., None]
    shape = in_all + np.float32(PARTLY) * (light.clipped - in_all)
    return np.asarray(shape * light.coverage[..., None])


def levels_below(
    finest: NDArray[np.float32], excess: NDArray[np.float32] | None = None
) -> LightPyramid:
    """Build the pyramid over a map.

    Args:
        finest: (N, N, 5) the finest level.
        excess: (N, N, 3), see :func:`excess_shape`; None for light that is all known.

    Returns:
        The pyramid.
    """
    levels = [finest]
    while len(levels[-1]) % 2 == 0:
        levels.append(halved(levels[-1]))
    return LightPyramid(levels, np.zeros_like(finest[..., RADIANCE]) if excess is None else excess)


def halved(level: NDArray[np.float32]) -> NDArray[np.float32]:
    """Halve a map's resolution by means over solid angle.

    Args:
        level: (N, N, C) octahedral map, N even.

    Returns:
        (N / 2, N / 2, C).
    """
    return _halved(kernel_array(level, np.float32), octahedral_solid_angles(len(level)))


def halved_to(level: NDArray[np.float32], size: int) -> NDArray[np.float32]:
    """Halve a map's resolution repeatedly.

    Args:
        level: (N, N, C) octahedral map; N is ``size`` times a power of two.
        size: Edge of the result.

    Returns:
        (size, size, C).
    """
    while len(level) > size:
        level = halved(level)
    return level


def doubled(image: NDArray[np.float32]) -> NDArray[np.float32]:
    """Double a map's resolution, and apply a binomial filter of width 3 along both edges.

    Args:
        image: (N, N, C).

    Returns:
        (2 N, 2 N, C).
    """
    return _doubled(kernel_array(image, np.float32))


@vectorised
def _halved(level: NDArray[np.float32], angles: NDArray[np.float32]) -> NDArray[np.float32]:
    size, channels = len(level) // 2, level.shape[2]
    means = np.empty((size, size, channels), np.float32)
    for row in range(size):
        for column in range(size):
            r, c = 2 * row, 2 * column
            first, second = angles[r, c], angles[r + 1, c]
            third, fourth = angles[r, c + 1], angles[r + 1, c + 1]
            total = (first + second) + (third + fourth)
            for n in range(channels):
                left = level[r, c, n] * first + level[r + 1, c, n] * second
                right = level[r, c + 1, n] * third + level[r + 1, c + 1, n] * fourth
                means[row, column, n] = (left + right) / total
    return means


@vectorised
def _doubled(image: NDArray[np.float32]) -> NDArray[np.float32]:
    size, channels = len(image), image.shape[2]
    wide, narrow = np.float32(0.5), np.float32(0.25)
    found = np.empty((2 * size, 2 * size, channels), np.float32)
    line = np.empty((size, channels), np.float32)
    for row in range(2 * size):
        above, here, below = max(row - 1, 0) // 2, row // 2, min(row + 1, 2 * size - 1) // 2
        for column in range(size):
            for n in range(channels):
                line[column, n] = (
                    narrow * image[above, column, n]
                    + wide * image[here, column, n]
                    + narrow * image[below, column, n]
                )
        for column in range(2 * size):
            left, right = max(column - 1, 0) // 2, min(column + 1, 2 * size - 1) // 2
            for n in range(channels):
                found[row, column, n] = (
                    narrow * line[left, n] + wide * line[column // 2, n] + narrow * line[right, n]
                )
    return found
