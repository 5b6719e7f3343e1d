# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Colours that say nothing of a material: black, overexposed, or noise."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled
from reflest_core.surface.observed_surface import ObservedSurface

DARKEST = 3
"""8-bit sRGB; below 0.1 % of white the steps of 8 bits are a third of the value and more."""
BRIGHTEST = 254
"""8-bit sRGB; from here on a channel is overexposed."""
MOST = 0.5
"""Share of dark or overexposed observations above which a surface is so."""
PAIRS = 4096
"""Of neighbouring voxels in one view that are compared for noise, about."""
FEWEST_PAIRS = 100
SPREAD = 0.2
"""Median over voxels of the standard deviation over the mean; matt surfaces have less than 0.1."""
FLOOR = 0.01
"""Added to the mean, linear, 1 for white: any sensor's noise is much of what is almost black."""
SHARED = 0.4
"""Correlation of what neighbours show in the same view. Highlights and mirrors give 0.5 and more,
noise gives 0, and up to 0.35 where voxels are finer than pixels and neighbours share these."""


@dataclass(frozen=True)
class ColourProblems:
    """What is wrong with a surface's colours.

    Attributes:
        too_dark: A sentence, or "".
        overexposed: A sentence, or "".
        noise: A sentence, or "".
    """

    too_dark: str = ""
    overexposed: str = ""
    noise: str = ""

    def __bool__(self) -> bool:
        """Whether there is any."""
        return bool(self.too_dark or self.overexposed or self.noise)


NO_PROBLEMS = ColourProblems()


def colour_problems(surface: ObservedSurface) -> ColourProblems:
    """Look whether the observations hold colours of a material at all.

    Args:
        surface: With keys, or noise is not looked for.

    Returns:
        What is wrong.
    """
    dark, bright = _extremes(surface.colours)
    if dark > MOST:
        return ColourProblems(
            too_dark=f"{dark:.0%} of the surface's observations are black: raise the exposure or "
            "give more light"
        )
    if bright > MOST:
        return ColourProblems(
            overexposed=f"{bright:.0%} of the surface's observations are overexposed: lower the "
            "exposure"
        )
    return ColourProblems(noise=_noise(surface))


def _noise(surface: ObservedSurface) -> str:
    if surface.keys is None or len(surface.colours) == 0:
        return ""
    step = max(len(surface.colours) // PAIRS, 1)
    voxels = np.arange(0, surface.voxel_count, step)
    spread = _spread(surface.offsets, surface.colours, voxels, _channel_brightness())
    if not spread > SPREAD:
        return ""
    order = np.argsort(surface.keys)
    found = np.searchsorted(surface.keys, surface.keys[voxels] + 1, sorter=order)
    neighbours = order[np.minimum(found, len(order) - 1)]
    are_there = surface.keys[neighbours] == surface.keys[voxels] + 1
    shared, pairs = _shared(
        surface.offsets,
        surface.colours,
        surface.view_indices,
        voxels[are_there],
        neighbours[are_there],
        len(surface.view_centres),
        _channel_brightness(),
    )
    if pairs < FEWEST_PAIRS or shared > SHARED:
        return ""
    return (
        f"the surface's colours are noise ({spread:.0%} between images, not shared by neighbours): "
        "give more light, or correct the poses"
    )


@compiled
def _extremes(colours: NDArray[np.uint8]) -> tuple[float, float]:
    """Shares of observations with all channels dark, and with any overexposed."""
    dark, bright, channels = np.int32(0), np.int32(0), colours.reshape(-1)
    for n in range(len(colours)):
        brightest = max(channels[3 * n], channels[3 * n + 1], channels[3 * n + 2])
        dark += np.int32(brightest <= DARKEST)
        bright += np.int32(brightest >= BRIGHTEST)
    count = max(len(colours), 1)
    return dark / count, bright / count


@compiled
def _spread(
    offsets: NDArray[np.int64],
    colours: NDArray[np.uint8],
    voxels: NDArray[np.int64],
    brightness: NDArray[np.float64],
) -> float:
    """Median over voxels of at least four observations; 0 where there are none."""
    spreads = np.zeros(len(voxels))
    count = 0
    for voxel in voxels:
        first, last = offsets[voxel], offsets[voxel + 1]
        if last - first >= 4:
            values = _brightness(colours[first:last], brightness)
            spreads[count] = values.std() / (values.mean() + FLOOR)
            count += 1
    return float(np.median(spreads[:count])) if count else 0.0


@compiled
def _shared(
    offsets: NDArray[np.int64],
    colours: NDArray[np.uint8],
    view_indices: NDArray[np.uint16],
    voxels: NDArray[np.int64],
    neighbours: NDArray[np.int64],
    views: int,
    brightness: NDArray[np.float64],
) -> tuple[float, int]:
    """Correlation of neighbours' deviations from their means in views of both, and their number."""
    by_view = np.zeros(views)
    product, own, other, pairs = 0.0, 0.0, 0.0, 0
    for index in range(len(voxels)):
        first, last = offsets[voxels[index]], offsets[voxels[index] + 1]
        begin, end = offsets[neighbours[index]], offsets[neighbours[index] + 1]
        if last - first < 4 or end - begin < 4:
            continue
        here = _brightness(colours[first:last], brightness)
        there = _brightness(colours[begin:end], brightness)
        by_view[:] = np.nan
        by_view[view_indices[first:last]] = here - here.mean()
        mean = there.mean()
        for at in range(begin, end):
            deviation = by_view[view_indices[at]]
            if not np.isnan(deviation):
                of_other = there[at - begin] - mean
                product += deviation * of_other
                own += deviation**2
                other += of_other**2
                pairs += 1
    scale = np.sqrt(own * other)
    return (product / scale if scale > 0.0 else 1.0), pairs


@compiled
def _brightness(colours: NDArray[np.uint8], of_channel: NDArray[np.float64]) -> NDArray[np.float64]:
    """(O,) roughly linear mean of the channels, 1 for white."""
    values = np.zeros(len(colours))
    for index in range(len(colours)):
        for channel in range(3):
            values[index] += of_channel[colours[index, channel]]
    return values


@cache
def _channel_brightness() -> NDArray[np.float64]:
    """(256,) what each 8-bit value of a channel adds to the brightness."""
    return np.asarray((np.arange(256) / 255.0) ** 2.2 / 3.0)
