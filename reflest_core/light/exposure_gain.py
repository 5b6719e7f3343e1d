# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How a frame is exposed, found from the background that it shares with the frames before it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.jit import compiled, kernel_array
from reflest_core.light.octahedral import octahedral_texel

LEAST_TEXELS = 20
"""Texels in common, of some 600 that a frame shows; fewer say nothing."""
DARKEST = 0.01
"""Mean luminance of a texel, before which steps of 8 bits and noise count for much."""
SAME_EXPOSURE = 0.04
"""Stops: what differs by less counts as not changed, so that a locked exposure stays exact."""
SHARED_EXPOSURE = 0.15
"""Stops: a frame adds to a stored view whose exposure is this near, above the noise of a gain."""
CLEAR_SHIFT = 0.5
"""Of the texels' median absolute deviation: what shifts less may be parallax or motion."""
CLEAR_SHIFT_OF_ONE = 6.0
"""The same over the square root of how many they are: three standard errors of their median."""
PARALLAX = 0.12
"""Stops: texels whose deviation is larger show a room that is too near for directions alone."""
DISAGREEMENT = 0.5
"""Stops: what deviates more says nothing of exposure."""
LARGEST_STEP = 1.5
"""Stops: a larger change from the frame before is not believed of voxels alone."""
MOST_STOPS = 6.0
"""A gain lies within so many stops of 1."""


ShiftSource = Callable[[], NDArray[np.float64]]
"""Returns the stops from a frame to the common exposure, one for each texel or voxel compared."""


def no_shifts() -> NDArray[np.float64]:
    """Compare nothing.

    Returns:
        No shifts.
    """
    return np.empty(0)


def exposure_gain(
    known: tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]],
    directions: NDArray[np.float32],
    colours: NDArray[np.uint8],
    last: float,
    surface_shifts: ShiftSource = no_shifts,
) -> float:
    """Find the factor that brings a frame's linear colours to the units of the light map.

    Texels in which anything is clipped are left out; the median of the rest counts. Where parallax
    makes them disagree, the surface's voxels are used instead if they agree better. Light that
    changes as a whole cannot be distinguished from exposure.

    Args:
        known: The map's sums (N, N, 3), counts (N, N) and clipped counts (N, N, 3), none empty.
        directions: (P, 3) towards the frame's background, see :meth:`.LightMap.add`.
        colours: (P, 3) 8-bit sRGB of the same.
        last: The gain of the frame before; it stays where the two share too little or do not
            clearly differ.
        surface_shifts: Called for the shifts of the surface's voxels where they are needed.

    Returns:
        The gain.
    """
    shifts = _shifts(
        *known,
        *_texels_of(
            kernel_array(directions, np.float32),
            kernel_array(colours, np.uint8),
            srgb.LINEAR,
            len(known[1]),
        ),
        DARKEST * DARKEST * last,
    )
    if len(shifts) < LEAST_TEXELS:
        return last
    stops, spread = _middle(shifts)
    if spread > PARALLAX:
        of_surface = surface_shifts()
        if len(of_surface) >= LEAST_TEXELS:
            its_stops, its_spread = _middle(of_surface)
            is_near = abs(its_stops - math.log2(last)) < LARGEST_STEP
            if is_near and its_spread < spread:
                shifts, stops, spread = of_surface, its_stops, its_spread
    if spread > DISAGREEMENT:
        return last
    clear = spread * max(CLEAR_SHIFT, CLEAR_SHIFT_OF_ONE / math.sqrt(len(shifts)))
    if abs(stops - math.log2(last)) < max(SAME_EXPOSURE, clear):
        return last
    return float(2.0 ** min(max(stops, -MOST_STOPS), MOST_STOPS))


def _middle(shifts: NDArray[np.float64]) -> tuple[float, float]:
    """Median and median absolute deviation."""
    stops = _median(shifts)
    return stops, _median(np.abs(shifts - stops))


def _median(values: NDArray[np.float64]) -> float:
    """As ``np.median`` gives it for finite values, without its overhead at every frame."""
    upper = len(values) // 2
    lower = upper - 1 + len(values) % 2
    middle = np.partition(values, (lower, upper))
    return float(0.5 * (middle[lower] + middle[upper]))


def may_share_view(gain: float, other: float) -> bool:
    """Decide whether a frame's observations may join a stored view.

    Args:
        gain: The frame's gain.
        other: The stored view's gain.

    Returns:
        Whether the exposures are near enough.
    """
    return abs(math.log2(gain / other)) < SHARED_EXPOSURE


@compiled
def _texels_of(
    directions: NDArray[np.float32],
    colours: NDArray[np.uint8],
    linear: NDArray[np.float32],
    size: int,
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_]]:
    """Sums (N, N, 3) and counts (N, N) of the pixels in each texel, and where one is clipped."""
    sums = np.zeros((size, size, 3), np.float32)
    counts = np.zeros((size, size), np.float32)
    clipped = np.zeros((size, size), np.bool_)
    for pixel in range(len(directions)):
        row, column = octahedral_texel(
            directions[pixel, 0], directions[pixel, 1], directions[pixel, 2], size
        )
        counts[row, column] += 1.0
        for channel in range(3):
            value = colours[pixel, channel]
            sums[row, column, channel] += linear[value]
            clipped[row, column] |= value == 255
    return sums, counts, clipped


@compiled
def _shifts(
    there_sums: NDArray[np.float32],
    there_counts: NDArray[np.float32],
    there_clipped: NDArray[np.float32],
    sums: NDArray[np.float32],
    counts: NDArray[np.float32],
    clipped: NDArray[np.bool_],
    least_product: float,
) -> NDArray[np.float64]:
    """Stops from the frame to the map in each texel that both show, unclipped and bright enough.

    Enough is a product of their luminances: it is the same whichever of the two noise has raised,
    and so prefers neither.
    """
    shifts = np.empty(counts.size, np.float64)
    found = 0
    for row in range(counts.shape[0]):
        for column in range(counts.shape[1]):
            if counts[row, column] == 0.0 or clipped[row, column]:
                continue
            if there_counts[row, column] == 0.0 or there_clipped[row, column].any():
                continue
            here = _luminance(sums[row, column]) / counts[row, column]
            there = _luminance(there_sums[row, column]) / there_counts[row, column]
            if here * there > least_product:
                shifts[found] = np.log2(there / here)
                found += 1
    return shifts[:found]


@compiled
def _luminance(linear: NDArray[np.float32]) -> float:
    """Of linear sRGB (Rec. 709)."""
    return float(0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2])
