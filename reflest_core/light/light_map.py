# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light seen in the background: a partial environment, gathered from every frame."""

from __future__ import annotations

from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.jit import compiled, kernel_array
from reflest_core.light.exposure_gain import ShiftSource, exposure_gain, no_shifts
from reflest_core.light.octahedral import octahedral_solid_angles, octahedral_texel

SIZE = 96
"""Texels along an edge of the octahedral map: 2.1 degrees each, in the mean."""
BYTES_OF_LIGHT = SIZE * SIZE * 8 * 4
LONGEST_MEMORY = 4096.0
"""Pixels of a texel after which its sums are halved, so that light that changes is followed."""

BRIGHTER = np.float32(1.1)
"""A frame whose white is so much brighter than another's knows more of what that one clipped."""


@dataclass(frozen=True)
class ObservedLight:
    """What was seen of the environment, as an octahedral map (:mod:`.octahedral`), world frame.

    Attributes:
        radiance: (N, N, 3) float32, mean linear sRGB, 1 at the sensor's white in the first frame,
            so that it passes 1 where a later frame was exposed less; 0 where unseen.
        coverage: (N, N) float32, 1 where seen.
        clipped: (N, N, 3) float32, share of what was seen there with this channel at 255, and never
            unclipped in a darker frame: a lower bound of the radiance, not a value.
    """

    radiance: NDArray[np.float32]
    coverage: NDArray[np.float32]
    clipped: NDArray[np.float32]

    @property
    def seen_share(self) -> float:
        """Share of the sphere of directions that was seen, in [0, 1]."""
        return _share(self.coverage)

    @property
    def any_clipped(self) -> NDArray[np.float32]:
        """(N, N): ``clipped`` of the channel that was clipped most."""
        red, green, blue = (self.clipped[..., channel] for channel in range(3))
        return np.maximum(np.maximum(red, green), blue)


@dataclass
class LightMap:
    """Sums over background pixels; bounded in size, whatever the length of the scan.

    Attributes:
        radiance_sum: (N, N, 3) float32.
        count: (N, N) float32 pixels.
        clipped_count: (N, N, 3) float32 clipped pixels.
        white: (N, N) float32, the radiance at which what is summed was clipped or would have been;
            0 where unseen.
        gain: Of the last frame, see :meth:`add_frame`.
    """

    radiance_sum: NDArray[np.float32] = field(
        default_factory=lambda: np.zeros((SIZE, SIZE, 3), np.float32)
    )
    count: NDArray[np.float32] = field(default_factory=lambda: np.zeros((SIZE, SIZE), np.float32))
    clipped_count: NDArray[np.float32] = field(
        default_factory=lambda: np.zeros((SIZE, SIZE, 3), np.float32)
    )
    white: NDArray[np.float32] = field(default_factory=lambda: np.zeros((SIZE, SIZE), np.float32))
    gain: float = 1.0

    def add_frame(
        self,
        directions: NDArray[np.float32],
        colours: NDArray[np.uint8],
        surface_shifts: ShiftSource = no_shifts,
    ) -> float:
        """Add the pixels of one frame at the exposure that it seems to have.

        Args:
            directions: (P, 3) towards the background, world frame, any length.
            colours: (P, 3) 8-bit sRGB.
            surface_shifts: Used where parallax makes the background doubtful, see
                :func:`.exposure_gain`.

        Returns:
            The frame's gain: the factor that brings its linear colours to the map's units.
        """
        known = (self.radiance_sum, self.count, self.clipped_count)
        self.gain = exposure_gain(known, directions, colours, self.gain, surface_shifts)
        self.add(directions, colours, self.gain)
        return self.gain

    def add(
        self, directions: NDArray[np.float32], colours: NDArray[np.uint8], gain: float = 1.0
    ) -> None:
        """Add pixels.

        Where frames disagree on what is clipped, the one with the brightest white counts.

        Args:
            directions: (P, 3) towards the background, world frame, any length.
            colours: (P, 3) 8-bit sRGB.
            gain: Factor on their linear light.
        """
        _accumulate(
            kernel_array(directions, np.float32),
            kernel_array(colours, np.uint8),
            srgb.LINEAR,
            np.float32(gain),
            self.radiance_sum,
            self.count,
            self.clipped_count,
            self.white,
        )

    @property
    def arrays(self) -> dict[str, NDArray[np.float32]]:
        """The sums by name, for saving and restoring."""
        return {name: getattr(self, name) for name in ARRAYS}

    @property
    def nbytes(self) -> int:
        """Bytes of the sums."""
        return sum(array.nbytes for array in self.arrays.values())

    @property
    def seen_share(self) -> float:
        """Share of the sphere of directions that was seen, in [0, 1]."""
        return _share((self.count > 0.0).astype(np.float32))

    def observed(self) -> ObservedLight:
        """Average what was added.

        Returns:
            A copy, which later frames do not change.
        """
        count = np.maximum(self.count, np.float32(1.0))
        return ObservedLight(
            np.asarray(self.radiance_sum / count[..., None], np.float32),
            (self.count > 0.0).astype(np.float32),
            np.asarray(self.clipped_count / count[..., None], np.float32),
        )


def _share(coverage: NDArray[np.float32]) -> float:
    angles = octahedral_solid_angles(len(coverage))
    return float((coverage * angles).sum() / (4.0 * np.pi))


ARRAYS = tuple(one.name for one in fields(LightMap) if one.name != "gain")


@compiled
def _accumulate(
    directions: NDArray[np.float32],
    colours: NDArray[np.uint8],
    linear: NDArray[np.float32],
    gain: np.float32,
    radiance_sum: NDArray[np.float32],
    count: NDArray[np.float32],
    clipped_count: NDArray[np.float32],
    white: NDArray[np.float32],
) -> None:
    size = len(count)
    rows, columns = np.empty(len(directions), np.int32), np.empty(len(directions), np.int32)
    clips_here = np.zeros((size, size), np.bool_)
    for pixel in range(len(directions)):
        row, column = octahedral_texel(
            directions[pixel, 0], directions[pixel, 1], directions[pixel, 2], size
        )
        rows[pixel], columns[pixel] = row, column
        is_clipped = (colours[pixel, 0] == 255) | (colours[pixel, 1] == 255)
        if is_clipped | (colours[pixel, 2] == 255):
            clips_here[row, column] = True
        if gain > white[row, column] * BRIGHTER:
            # Clipped sums start over: beside them lies only the dark part of the texel.
            if clipped_count[row, column].any():
                count[row, column] = 0.0
                clipped_count[row, column] = 0.0
                radiance_sum[row, column] = 0.0
            white[row, column] = gain
    for pixel in range(len(directions)):
        row, column = rows[pixel], columns[pixel]
        if clips_here[row, column] and gain * BRIGHTER < white[row, column]:
            continue
        count[row, column] += 1.0
        for channel in range(3):
            value = colours[pixel, channel]
            radiance_sum[row, column, channel] += linear[value] * gain
            if value == 255:
                clipped_count[row, column, channel] += 1.0
        if count[row, column] >= LONGEST_MEMORY:
            count[row, column] *= 0.5
            clipped_count[row, column] *= 0.5
            radiance_sum[row, column] *= 0.5
