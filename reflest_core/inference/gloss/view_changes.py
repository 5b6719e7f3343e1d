# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How a voxel's colour changes from view to view, by the angle between the views.

The mean squared change by angle is the structure function of the reflections: whatever the light, a
rough surface blurs it, so that little changes between close views, and a polished one shows rare,
strong highlights. Only changes within a voxel count, so neither albedo nor diffuse light matters.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.inference.gloss.colour_noise import colour_variances
from reflest_core.jit import compiled, kernel_array
from reflest_core.surface.observed_surface import ObservedSurface

MOST_VOXELS, MOST_VIEWS = 1000, 16
"""Voxels of a material and views of each that are compared at most."""
CLOSEST, MIDDLE, FARTHEST = math.radians(3.0), math.radians(20.0), math.radians(60.0)
"""Angles between views: near pairs lie between the first two, far pairs between the last two."""
STEEPEST = 0.3
"""Cosine between normal and view, below which a view is left out."""
LUMINANCE = (0.2126, 0.7152, 0.0722)
"""Weights of Rec. 709."""
LEAST = 1e-9
"""Added to every mean, which may be 0."""


@dataclass(frozen=True)
class ViewChanges:
    """Moments of the changes of a material's luminance between views of one voxel.

    Attributes:
        near_square: mean squared change between near views, linear.
        far_square: the same between far views.
        far_change: mean absolute change between far views.
        square: mean squared change of all pairs.
        fourth: mean fourth power of the change of all pairs.
        noise: mean of the squared change that noise alone makes.
        pairs: how many pairs of views were compared.
    """

    near_square: float
    far_square: float
    far_change: float
    square: float
    fourth: float
    noise: float
    pairs: int

    @property
    def blur(self) -> float:
        """Half the logarithm of the near over the far mean squared change: low where blurred."""
        return 0.5 * math.log(self.near_square / self.far_square)

    @property
    def peakedness(self) -> float:
        """A quarter of the logarithm of the changes' kurtosis: high for rare, strong highlights."""
        return 0.25 * math.log(self.fourth / self.square**2)

    @property
    def over_noise(self) -> float:
        """Logarithm of the mean change between far views over the noise."""
        return math.log(self.far_change / math.sqrt(self.noise))


def view_changes(surface: ObservedSurface, voxels: NDArray[np.int64]) -> ViewChanges | None:
    """Compare the views of each voxel of a material with each other.

    Args:
        surface: V voxels with their observations.
        voxels: (N,) indices of the material's voxels.

    Returns:
        The moments; None where no two views of one voxel can be compared.
    """
    if not len(voxels):
        return None
    chosen = np.unique(np.linspace(0, len(voxels) - 1, MOST_VOXELS).astype(np.int64))
    near, far = _moments(
        kernel_array(surface.positions, np.float32),
        kernel_array(surface.normals, np.float32),
        surface.offsets,
        surface.colours,
        surface.view_indices,
        surface.view_centres,
        kernel_array(voxels[chosen], np.int64),
        srgb.LINEAR,
        colour_variances(),
    )
    both = near + far
    if both[0] == 0.0:
        return None

    def mean(moments: NDArray[np.float64], which: int) -> float:
        return float((moments[which] + LEAST) / max(moments[0], 1.0))

    return ViewChanges(
        near_square=mean(near, 3),
        far_square=mean(far, 3),
        far_change=mean(far, 2),
        square=mean(both, 3),
        fourth=mean(both, 4),
        noise=mean(both, 1),
        pairs=int(both[0]),
    )


@compiled
def _moments(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    offsets: NDArray[np.int64],
    colours: NDArray[np.uint8],
    view_indices: NDArray[np.uint16],
    view_centres: NDArray[np.float32],
    voxels: NDArray[np.int64],
    linear: NDArray[np.float32],
    variances: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Of near and of far pairs: their number; sums of noise, ``|d|``, ``d^2`` and ``d^4``."""
    near, far = np.zeros(5), np.zeros(5)
    directions = np.empty((MOST_VIEWS, 3))
    shown, noise = np.empty(MOST_VIEWS), np.empty(MOST_VIEWS)
    for voxel in voxels:
        first, made = offsets[voxel], offsets[voxel + 1] - offsets[voxel]
        taken, kept = min(made, MOST_VIEWS), 0
        for slot in range(taken):
            row = first + slot * made // taken
            if max(colours[row, 0], colours[row, 1], colours[row, 2]) == 255:
                continue
            length, cosine = 0.0, 0.0
            for axis in range(3):
                step = view_centres[view_indices[row], axis] - positions[voxel, axis]
                directions[kept, axis] = step
                length += step * step
                cosine += step * normals[voxel, axis]
            length = math.sqrt(length)
            if not cosine > STEEPEST * length:
                continue
            shown[kept], noise[kept] = 0.0, 0.0
            for channel in range(3):
                directions[kept, channel] /= length
                colour = colours[row, channel]
                shown[kept] += LUMINANCE[channel] * linear[colour]
                noise[kept] += LUMINANCE[channel] ** 2 * variances[colour]
            kept += 1
        for one in range(kept):
            for other in range(one + 1, kept):
                cosine = 0.0
                for axis in range(3):
                    cosine += directions[one, axis] * directions[other, axis]
                angle = math.acos(min(cosine, 1.0))
                if not CLOSEST < angle <= FARTHEST:
                    continue
                moments = near if angle <= MIDDLE else far
                change = abs(shown[one] - shown[other])
                square = change * change
                moments[0] += 1.0
                moments[1] += noise[one] + noise[other]
                moments[2] += change
                moments[3] += square
                moments[4] += square * square
    return near, far
