# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Completion of a partial environment: unseen directions take the mean of what lies around them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
            filled = smoothed(np.repeat(np.repeat(filled, 2, axis=0), 2, axis=1))
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
    size = len(level)
    angles = octahedral_solid_angles(size)[..., None]
    weighted = _sum_of_fours(level * angles)
    return np.asarray(weighted / _sum_of_fours(angles), np.float32)


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


def _sum_of_fours(image: NDArray[np.float32]) -> NDArray[np.float32]:
    rows = image[0::2] + image[1::2]
    return np.asarray(rows[:, 0::2] + rows[:, 1::2])


def smoothed(image: NDArray[np.float32]) -> NDArray[np.float32]:
    """Apply a binomial filter of width 3 along both edges of a map.

    Args:
        image: (N, N, C).

    Returns:
        (N, N, C).
    """
    padded = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge")
    rows = 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:]
    return np.asarray(0.25 * rows[:, :-2] + 0.5 * rows[:, 1:-1] + 0.25 * rows[:, 2:])
