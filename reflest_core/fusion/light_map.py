# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light seen in the background: a partial environment, gathered from every frame."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.fusion.octahedral import octahedral_solid_angles, octahedral_texel
from reflest_core.jit import compiled, kernel_array

SIZE = 96
"""Texels along an edge of the octahedral map: 2.1 degrees each, in the mean."""
BYTES_OF_LIGHT = SIZE * SIZE * 5 * 4
LONGEST_MEMORY = 4096.0
"""Pixels of a texel after which its sums are halved, so that light that changes is followed."""

_LINEAR = np.asarray(srgb.decode(np.arange(256) / 255.0), np.float32)


@dataclass(frozen=True)
class ObservedLight:
    """What was seen of the environment, as an octahedral map (:mod:`.octahedral`), world frame.

    ``radiance``: (N, N, 3) float32, mean linear sRGB, 1 at the sensor's white; 0 where unseen.
    ``coverage``: (N, N) float32, 1 where seen. ``clipped``: (N, N) float32, share of what was seen
    there with a channel at 255: a lower bound of the radiance, not a value.
    """

    radiance: NDArray[np.float32]
    coverage: NDArray[np.float32]
    clipped: NDArray[np.float32]

    @property
    def seen_share(self) -> float:
        """Share of the sphere of directions that was seen, in [0, 1]."""
        angles = octahedral_solid_angles(len(self.coverage))
        return float((self.coverage * angles).sum() / (4.0 * np.pi))


@dataclass
class LightMap:
    """Sums over background pixels; bounded in size, whatever the length of the scan.

    ``radiance_sum``: (N, N, 3), ``count`` and ``clipped_count``: (N, N), float32.
    """

    radiance_sum: NDArray[np.float32] = field(
        default_factory=lambda: np.zeros((SIZE, SIZE, 3), np.float32)
    )
    count: NDArray[np.float32] = field(default_factory=lambda: np.zeros((SIZE, SIZE), np.float32))
    clipped_count: NDArray[np.float32] = field(
        default_factory=lambda: np.zeros((SIZE, SIZE), np.float32)
    )

    def add(self, directions: NDArray[np.float32], colours: NDArray[np.uint8]) -> None:
        """Add pixels: ``directions`` (P, 3) towards the background, world frame, of any length.

        ``colours``: (P, 3) 8-bit sRGB.
        """
        _accumulate(
            kernel_array(directions, np.float32), kernel_array(colours, np.uint8), _LINEAR,
            self.radiance_sum, self.count, self.clipped_count,
        )  # fmt: skip

    @property
    def arrays(self) -> dict[str, NDArray[np.float32]]:
        """The sums by name, for saving and restoring."""
        return dict(vars(self))

    @property
    def nbytes(self) -> int:
        """Bytes of the sums."""
        return sum(array.nbytes for array in self.arrays.values())

    def observed(self) -> ObservedLight:
        """The mean of what was added, a copy."""
        count = np.maximum(self.count, np.float32(1.0))
        return ObservedLight(
            np.asarray(self.radiance_sum / count[..., None], np.float32),
            (self.count > 0.0).astype(np.float32),
            np.asarray(self.clipped_count / count, np.float32),
        )


@compiled
def _accumulate(
    directions: NDArray[np.float32],
    colours: NDArray[np.uint8],
    linear: NDArray[np.float32],
    radiance_sum: NDArray[np.float32],
    count: NDArray[np.float32],
    clipped_count: NDArray[np.float32],
) -> None:
    size = len(count)
    for pixel in range(len(directions)):
        row, column = octahedral_texel(
            directions[pixel, 0], directions[pixel, 1], directions[pixel, 2], size
        )
        count[row, column] += 1.0
        is_clipped = False
        for channel in range(3):
            value = colours[pixel, channel]
            radiance_sum[row, column, channel] += linear[value]
            is_clipped |= value == 255
        if is_clipped:
            clipped_count[row, column] += 1.0
        if count[row, column] >= LONGEST_MEMORY:
            count[row, column] *= 0.5
            clipped_count[row, column] *= 0.5
            radiance_sum[row, column] *= 0.5
