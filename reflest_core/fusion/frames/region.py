# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The region of interest: a box or a sphere in the world frame that holds the scanned object."""

from __future__ import annotations

import enum
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.settings import RegionSettings
from reflest_core.jit import compiled, kernel_array


class RegionShape(enum.IntEnum):
    """What bounds the scanned object."""

    NONE = 0
    BOX = 1
    SPHERE = 2


@dataclass(frozen=True)
class Region:
    """What bounds the scanned surface.

    Attributes:
        shape: Box, sphere or nothing.
        centre: (3,) float64, world frame, metres.
        half_size: (3,) float64, metres along the world's axes; a sphere's radius is first.
    """

    shape: RegionShape
    centre: NDArray[np.float64]
    half_size: NDArray[np.float64]

    @classmethod
    def from_settings(cls, settings: RegionSettings) -> Region:
        """Take the region that the user described.

        Args:
            settings: The description.

        Returns:
            The region.
        """
        return cls(
            RegionShape[settings.shape.upper()],
            np.array(settings.centre, np.float64),
            np.array(settings.size, np.float64) / 2.0,
        )

    def relative_to(self, origin: NDArray[np.float64]) -> Region:
        """Return the region in coordinates that begin elsewhere.

        Args:
            origin: (3,) world frame, metres.
        """
        return replace(self, centre=self.centre - origin)

    def shows(self, frame: Frame) -> NDArray[np.bool_]:
        """Find the pixels of a frame whose depth lies in the region.

        Args:
            frame: The frame, in the same coordinates.

        Returns:
            (H, W) bool; without a region all pixels with depth.
        """
        depth = kernel_array(frame.depth, np.float32)
        if self.shape is RegionShape.NONE:
            return np.asarray(depth > 0.0)
        inside = np.empty(depth.shape, np.bool_)
        pose, K = kernel_array(frame.T_world_camera, np.float64), frame.intrinsics.matrix
        region = int(self.shape), self.centre, self.half_size
        pixels_in_region(0, len(depth), depth, pose, K, *region, inside)
        return inside

    def contains(self, points: NDArray[np.floating]) -> NDArray[np.bool_]:
        """Test points; the boundary counts as inside.

        Args:
            points: (N, 3) world frame, metres.

        Returns:
            (N,) bool.
        """
        flat = kernel_array(points, np.float64)
        return _inside_all(int(self.shape), self.centre, self.half_size, flat)


@compiled
def inside_region(
    shape: int,
    centre: NDArray[np.float64],
    half_size: NDArray[np.float64],
    x: float,
    y: float,
    z: float,
) -> bool:
    """Test a point; everything is inside where there is no region. A kernel.

    Args:
        shape: A :class:`RegionShape` as a number.
        centre: (3,) metres.
        half_size: (3,) metres.
        x: Of the point, world frame, metres.
        y: The same.
        z: The same.

    Returns:
        Whether the point lies in the region.
    """
    dx, dy, dz = x - centre[0], y - centre[1], z - centre[2]
    if shape == 1:
        return bool(abs(dx) <= half_size[0] and abs(dy) <= half_size[1] and abs(dz) <= half_size[2])
    if shape == 2:
        return bool(dx * dx + dy * dy + dz * dz <= half_size[0] * half_size[0])
    return True


@compiled
def _inside_all(
    shape: int,
    centre: NDArray[np.float64],
    half_size: NDArray[np.float64],
    points: NDArray[np.float64],
) -> NDArray[np.bool_]:
    inside = np.empty(len(points), np.bool_)
    for n in range(len(points)):
        inside[n] = inside_region(
            shape, centre, half_size, points[n, 0], points[n, 1], points[n, 2]
        )
    return inside


@compiled
def pixels_in_region(
    start: int,
    stop: int,
    depth: NDArray[np.float32],
    T: NDArray[np.float64],
    K: NDArray[np.float64],
    shape: int,
    centre: NDArray[np.float64],
    half_size: NDArray[np.float64],
    inside: NDArray[np.bool_],
) -> None:
    """Find the pixels with depth whose back-projected point lies in a region; a kernel.

    Args:
        start: First of the rows that are filled.
        stop: The one after the last.
        depth: (H, W) metres, 0 unknown.
        T: (4, 4) camera to world.
        K: (3, 3) intrinsics.
        shape: A :class:`RegionShape` as a number, not that of no region.
        centre: (3,) metres.
        half_size: (3,) metres.
        inside: (H, W) filled.
    """
    to_camera = (T[:3, 3] - centre).astype(np.float32)
    half = half_size.astype(np.float32)
    ray = np.empty(3, np.float32)
    step = (T[:3, 0] / K[0, 0]).astype(np.float32)
    for v in range(start, stop):
        for axis in range(3):
            ray[axis] = (
                T[axis, 1] * (v - K[1, 2]) / K[1, 1] - T[axis, 0] * K[0, 2] / K[0, 0] + T[axis, 2]
            )
        _fill_row(depth[v], to_camera, ray, step, shape, half, inside[v])


@compiled
def _fill_row(
    depth: NDArray[np.float32],
    origin: NDArray[np.float32],
    ray: NDArray[np.float32],
    step: NDArray[np.float32],
    shape: int,
    half: NDArray[np.float32],
    inside: NDArray[np.bool_],
) -> None:
    """One row, relative to the region's centre; without branches, for vector instructions."""
    x0, y0, z0 = origin[0], origin[1], origin[2]
    rx, ry, rz = ray[0], ray[1], ray[2]
    sx, sy, sz = step[0], step[1], step[2]
    hx, hy, hz = half[0], half[1], half[2]
    is_sphere = shape == RegionShape.SPHERE
    for u in range(len(depth)):
        n, z = np.float32(np.int32(u)), depth[u]
        x = x0 + z * (rx + n * sx)
        y = y0 + z * (ry + n * sy)
        w = z0 + z * (rz + n * sz)
        in_box = (abs(x) <= hx) & (abs(y) <= hy) & (abs(w) <= hz)
        in_sphere = x * x + y * y + w * w <= hx * hx
        inside[u] = (z > np.float32(0.0)) & (in_sphere if is_sphere else in_box)
