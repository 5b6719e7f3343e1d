# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Edges of one frame's colours and of its depth, on a reduced image.

Where an object ends, depth steps, and colours nearly always change: in a right frame the edges of
the two images lie on each other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.poses.colour_agreement import grey_blocks
from reflest_core.jit import compiled, kernel_array

COLUMNS = 160
"""Columns of a reduced image, about."""
FEWEST_PIXELS = 24
"""Smaller images, rows or columns of the reduced one, have no edge maps."""
STEP = 0.04
"""Step of depth from one side of a pixel to the other, as a share of the greater one, that is an
edge; a missing depth counts as 0."""
STRONG = 20.0
"""Grey levels from one side of a pixel to the other that count half as much as any edge can."""
SURROUNDINGS = 6
"""Pixels of the reduced image on each side whose mean is taken away."""
FEWEST_EDGES = 0.002
"""Share of pixels on a depth edge from which on a frame says something."""


@dataclass(frozen=True)
class EdgeMaps:
    """Where a frame's edges are: two images over the mean of their surroundings, of length 1.

    Attributes:
        colour: (h, w) float32.
        depth: (h, w) float32, all 0 where the frame shows no edges of depth.
        size: Pixels of the frame in one of the reduced images, along each axis.
    """

    colour: NDArray[np.float32]
    depth: NDArray[np.float32]
    size: int

    @property
    def is_known(self) -> bool:
        """Whether both images have edges."""
        return bool(self.depth.any() and self.colour.any())

    @staticmethod
    def of(frame: Frame) -> EdgeMaps | None:
        """Find the edges of a frame.

        Args:
            frame: Colours and depth of one size.

        Returns:
            The maps; None for an image too small.
        """
        size = max(frame.rgb.shape[1] // COLUMNS, 1)
        if min(frame.rgb.shape[:2]) // size < FEWEST_PIXELS:
            return None
        rgb, depth = kernel_array(frame.rgb, np.uint8), kernel_array(frame.depth, np.float32)
        colour, steps = _edges(rgb, depth, size)
        if np.count_nonzero(steps) < FEWEST_EDGES * steps.size:
            steps[:] = 0.0
        return EdgeMaps(
            unit(_without_surroundings(colour)), unit(_without_surroundings(steps)), size
        )


def unit(image: NDArray[np.float32]) -> NDArray[np.float32]:
    """Scale an image to length 1, as a vector.

    Args:
        image: Of any shape.

    Returns:
        The image; as it is where it is 0.
    """
    length = float(np.sqrt(np.vdot(image, image)))
    return image / np.float32(length) if length > 1e-6 else np.zeros_like(image)


@compiled
def _edges(
    rgb: NDArray[np.uint8], depth: NDArray[np.float32], size: int
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Strength of colour edges in [0, 1), and 1 on depth edges, of the reduced image."""
    grey = grey_blocks(rgb, size)
    height, width = grey.shape
    reduced = np.empty((height, width), np.float32)
    for row in range(height):
        for column in range(width):
            reduced[row, column] = depth[row * size + size // 2, column * size + size // 2]
    colour = np.zeros((height, width), np.float32)
    steps = np.zeros((height, width), np.float32)
    for row in range(1, height - 1):
        _slopes(grey[row], grey[row - 1], grey[row + 1], colour[row])
        _steps(reduced[row], reduced[row - 1], reduced[row + 1], steps[row])
    return colour, steps


@compiled
def _slopes(
    here: NDArray[np.float32],
    above: NDArray[np.float32],
    below: NDArray[np.float32],
    colour: NDArray[np.float32],
) -> None:
    """One row; from neighbours in slices, for vector instructions."""
    before, after, up, down, found = here[:-2], here[2:], above[1:-1], below[1:-1], colour[1:-1]
    for n in range(len(found)):
        right, under = after[n] - before[n], down[n] - up[n]
        slope = np.sqrt(right * right + under * under)
        found[n] = slope / (slope + STRONG)


@compiled
def _steps(
    here: NDArray[np.float32],
    above: NDArray[np.float32],
    below: NDArray[np.float32],
    steps: NDArray[np.float32],
) -> None:
    """One row likewise."""
    before, after, up, down, found = here[:-2], here[2:], above[1:-1], below[1:-1], steps[1:-1]
    for n in range(len(found)):
        is_step = _is_step(before[n], after[n]) | _is_step(up[n], down[n])
        found[n] = np.float32(1.0) if is_step else np.float32(0.0)


@compiled
def _is_step(here: float, there: float) -> bool:
    return bool(abs(here - there) > STEP * max(here, there))


@compiled
def _without_surroundings(image: NDArray[np.float32]) -> NDArray[np.float32]:
    """The image over the mean of its surroundings; 0 within their reach of the border."""
    height, width = image.shape
    sums = np.zeros((height + 1, width + 1), np.float64)
    for row in range(height):
        along = 0.0
        for column in range(width):
            along += image[row, column]
            sums[row + 1, column + 1] = sums[row, column + 1] + along
    reach = SURROUNDINGS
    count = (2 * reach + 1) ** 2
    found = np.zeros((height, width), np.float32)
    for row in range(reach, height - reach):
        for column in range(reach, width - reach):
            total = (
                sums[row + reach + 1, column + reach + 1] - sums[row - reach, column + reach + 1]
            )
            total += sums[row - reach, column - reach] - sums[row + reach + 1, column - reach]
            found[row, column] = image[row, column] - total / count
    return found
