# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A frozen copy of what has been seen: the one type that features are built from.

Live scans and SynBRDF scenes both arrive here, so that training and estimation share every line
of feature code.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, fields

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, kernel_array
from reflest_core.light.light_map import ObservedLight

NEIGHBOUR_RADIUS = 0.009
"""Metres: in a grid of 5 mm the direct and the diagonal neighbours."""
COARSE, DIAGONAL = 0.9, 1.8
"""Voxels of more than this share of it have their neighbours within this many of their edges."""


@dataclass(frozen=True)
class ObservedSurface:
    """V surface voxels, O observations grouped by voxel (CSR) and W views.

    Attributes:
        positions: (V, 3) float32, world frame less ``origin``, metres.
        normals: (V, 3) float32, world frame, unit length, outward.
        offsets: (V + 1,) int64; voxel k owns the observations ``offsets[k]:offsets[k + 1]``.
        colours: (O, 3) uint8, 8-bit sRGB.
        view_indices: (O,) uint16, indices into the view arrays.
        view_centres: (W, 3) float32, camera centres, world frame less ``origin``, metres.
        view_foreground: (W, 3) float32, mean 8-bit colour F in [0, 255]; NaN where a view has no
            foreground pixels.
        view_background: (W, 3) float32, the same for B and the background.
        light: What the background showed of the environment; None where it was not gathered.
        keys: (V,) int64, the packed key of each voxel (:mod:`.voxel_key`) in the order of
            ``positions``: it stays with a voxel from keyframe to keyframe. None for synthetic
            scenes. Files do not store it.
        origin: (3,) float64, of the surface's coordinates in the world frame, metres: not 0 where
            a scan lies far from the world's origin. Positions and centres are relative to it.
        voxel_size: edge of a voxel, metres; 0 for points without a grid.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    offsets: NDArray[np.int64]
    colours: NDArray[np.uint8]
    view_indices: NDArray[np.uint16]
    view_centres: NDArray[np.float32]
    view_foreground: NDArray[np.float32]
    view_background: NDArray[np.float32]
    light: ObservedLight | None = None
    keys: NDArray[np.int64] | None = None
    origin: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    voxel_size: float = 0.0

    @property
    def voxel_count(self) -> int:
        """V, the number of voxels."""
        return len(self.positions)

    @property
    def neighbour_radius(self) -> float:
        """Metres within which voxels are neighbours: direct ones always are."""
        is_coarse = self.voxel_size > COARSE * NEIGHBOUR_RADIUS
        return DIAGONAL * self.voxel_size if is_coarse else NEIGHBOUR_RADIUS

    @property
    def world_positions(self) -> NDArray[np.floating]:
        """(V, 3) world frame, metres: float64 where there is an ``origin``, else float32."""
        return self.positions + self.origin if self.origin.any() else self.positions

    @property
    def voxel_keys(self) -> NDArray[np.int64]:
        """(V,) int64, distinct: :attr:`keys`, or the voxels' indices where there are none."""
        return np.arange(self.voxel_count) if self.keys is None else self.keys

    @property
    def observation_counts(self) -> NDArray[np.int64]:
        """(V,) observations of each voxel."""
        return np.diff(self.offsets)

    @property
    def observing_views(self) -> int:
        """Views that hold at least one of the observations."""
        return int(self.is_observing.sum())

    @property
    def is_observing(self) -> NDArray[np.bool_]:
        """(W,) True for views that hold at least one of the observations."""
        return _occurring(self.view_indices, len(self.view_centres))

    def view_directions(self) -> NDArray[np.float32]:
        """Return the direction ``omega_o`` of every observation.

        Returns:
            (O, 3) float32 unit vectors from voxel to camera centre.
        """
        voxel_of = np.repeat(np.arange(self.voxel_count), self.observation_counts)
        return self.directions_of(slice(None), voxel_of)

    def directions_of(
        self, rows: NDArray[np.int64] | slice, voxels: NDArray[np.int64]
    ) -> NDArray[np.float32]:
        """Return the directions ``omega_o`` of some observations.

        Args:
            rows: The observations, R of them.
            voxels: (R,) the voxel of each.

        Returns:
            (R, 3) unit vectors from voxel to camera centre; the normal where the two coincide.
        """
        return _directions(
            kernel_array(self.positions, np.float32),
            kernel_array(self.normals, np.float32),
            kernel_array(self.view_centres, np.float32),
            kernel_array(self.view_indices[rows], np.uint16),
            kernel_array(voxels, np.int64),
        )


@compiled
def _directions(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    view_centres: NDArray[np.float32],
    views: NDArray[np.uint16],
    voxels: NDArray[np.int64],
) -> NDArray[np.float32]:
    directions = np.empty((len(voxels), 3), np.float32)
    for row in range(len(voxels)):
        position, centre = positions[voxels[row]], view_centres[views[row]]
        x, y, z = centre[0] - position[0], centre[1] - position[1], centre[2] - position[2]
        length = np.sqrt(x * x + y * y + z * z)
        if length == 0.0:
            directions[row] = normals[voxels[row]]
        else:
            directions[row, 0], directions[row, 1] = x / length, y / length
            directions[row, 2] = z / length
    return directions


@compiled
def _occurring(indices: NDArray[np.uint16], limit: int) -> NDArray[np.bool_]:
    """(limit,) which values below ``limit`` there are."""
    is_there = np.zeros(limit, np.bool_)
    for index in indices:
        is_there[index] = True
    return is_there


SURFACE_ARRAYS = tuple(
    one.name
    for one in fields(ObservedSurface)
    if one.name not in ("light", "keys", "origin", "voxel_size")
)
"""Names of the arrays, which files store one by one."""


def digest(surface: ObservedSurface) -> bytes:
    """Return a hash of all that a surface holds.

    Args:
        surface: the surface, with or without light.
    """
    arrays = [getattr(surface, one.name) for one in fields(surface) if one.name != "light"]
    if surface.light is not None:
        arrays += [surface.light.radiance, surface.light.coverage, surface.light.clipped]
    found = hashlib.blake2b(digest_size=16)
    for array in arrays:
        found.update(b"" if array is None else np.asarray(array).tobytes())
    return found.digest()
