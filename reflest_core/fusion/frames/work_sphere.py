# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The work sphere: what is scanned where there is neither a region of interest nor a mask.

A pixel without depth, or whose point lies outside the sphere, is background: it shows light and is
never fused. Centre and radius follow from the first :data:`EARLY_FRAMES` frames and then stay. Of
each of them, the pixels of the middle of the image give a median depth and a median point; the
centre is the mean of these points, and the automatic radius is :data:`RADII` times the mean of
these depths.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.capture.pose import FURTHEST
from reflest_core.fusion.frames.region import Region, RegionShape
from reflest_core.fusion.settings import FusionSettings

EARLY_FRAMES = 10
"""Fused frames after which the sphere stays as it is."""

RADII = 2.0
"""Automatic radius over the median distance from the camera to the surface."""

STRIDE = 4
"""Every fourth pixel along each axis is used."""

HALF_WINDOW = 0.05
"""Of the shorter side of the image: half the edge of the square whose median depth counts in
:func:`view_middle`."""


@dataclass(frozen=True)
class WorkSphere:
    """A ball in the world frame.

    Attributes:
        centre: x, y, z in metres.
        distance: Mean of the median depths of the early frames, metres.
        frames: Frames that it was found from, at most :data:`EARLY_FRAMES`.
    """

    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    distance: float = 0.0
    frames: int = 0

    @classmethod
    def from_json(cls, stored: Any) -> WorkSphere:
        """Read what ``dataclasses.asdict`` wrote; older files have none: an empty sphere.

        Args:
            stored: The fields by name, or None.

        Returns:
            The sphere.

        Raises:
            ValueError: A value is not a number within its range.
        """
        if stored is None:
            return cls()
        names = ("centre", "distance", "frames")
        if type(stored) is not dict or not all(name in stored for name in names):
            raise ValueError("the work sphere has no centre, distance or frames")
        centre, distance, frames = (stored[name] for name in names)
        if type(centre) is not list or len(centre) != 3:
            raise ValueError("the work sphere's centre is not three numbers")
        if not all(_is_length(value) for value in (*centre, distance)) or distance < 0.0:
            raise ValueError(f"the work sphere holds a length that is not within {FURTHEST:g} m")
        if type(frames) is not int or not 0 <= frames <= EARLY_FRAMES:
            raise ValueError(f"the work sphere is not of 0 to {EARLY_FRAMES} frames")
        x, y, z = map(float, centre)
        return cls((x, y, z), float(distance), frames)

    def updated(self, frame: Frame, settings: FusionSettings) -> WorkSphere:
        """Take one more early frame into account.

        Args:
            frame: The next frame.
            settings: ``max_depth`` limits which depth counts.

        Returns:
            The new sphere; the same one after the early frames, or where the frame has no depth.
        """
        if self.frames >= EARLY_FRAMES:
            return self
        found = _middle_of(frame, settings.max_depth)
        if found is None:
            return self
        point, depth = found
        count = self.frames + 1
        before = np.array([*self.centre, self.distance])
        x, y, z, distance = (before + (np.array([*point, depth]) - before) / count).tolist()
        return WorkSphere((x, y, z), distance, count)

    def radius(self, settings: FusionSettings) -> float:
        """Return the work radius.

        Args:
            settings: ``work_radius``; 0 is the automatic one.

        Returns:
            Metres.
        """
        return settings.work_radius if settings.work_radius > 0.0 else RADII * self.distance

    def region(self, settings: FusionSettings) -> Region:
        """Return the sphere as a region of interest.

        Args:
            settings: ``work_radius``; 0 is the automatic one.

        Returns:
            The region; of no extent before the first frame.
        """
        return Region(
            RegionShape.SPHERE,
            np.array(self.centre, np.float64),
            np.full(3, self.radius(settings) if self.frames else 0.0),
        )


def _is_length(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) <= FURTHEST


def _middle_of(frame: Frame, max_depth: float) -> tuple[NDArray[np.float64], float] | None:
    """Median point (3,), world frame, and median depth of the middle of the image.

    The middle is the central half of the rows and columns; all of them where that has no depth.
    """
    height, width = frame.depth.shape
    middle = (slice(height // 4, height - height // 4), slice(width // 4, width - width // 4))
    camera = frame.intrinsics
    v, u = np.mgrid[:height:STRIDE, :width:STRIDE]
    depth = frame.depth[::STRIDE, ::STRIDE].astype(np.float64)
    is_usable = _is_usable(depth, max_depth)
    is_central = np.zeros((height, width), np.bool_)
    is_central[middle] = True
    is_central = is_central[::STRIDE, ::STRIDE] & is_usable
    chosen = is_central if is_central.any() else is_usable
    if not chosen.any():
        return None
    z = depth[chosen]
    rays = np.stack(
        [(u[chosen] - camera.cx) / camera.fx, (v[chosen] - camera.cy) / camera.fy, np.ones(len(z))]
    )
    points = frame.T_world_camera[:3, :3] @ (rays * z) + frame.T_world_camera[:3, 3:]
    return np.median(points, axis=1), float(np.median(z))


def view_middle(frame: Frame, max_depth: float) -> NDArray[np.float64] | None:
    """Find the surface point that the middle of an image shows.

    It lies on the ray through the centre of the image, at the median depth of a small square
    about it; where that has no depth, it is the point of the nearest pixel that has.

    Args:
        frame: the whole frame.
        max_depth: farther depth does not count, metres.

    Returns:
        (3,) world frame, metres; None where no pixel has depth.
    """
    height, width = frame.depth.shape
    half = max(round(HALF_WINDOW * min(height, width)), 1)
    row, column = height // 2, width // 2
    square = frame.depth[
        max(row - half, 0) : row + half + 1, max(column - half, 0) : column + half + 1
    ]
    near = square[_is_usable(square, max_depth)]
    if len(near):
        return _world_point(frame, (width - 1) / 2, (height - 1) / 2, float(np.median(near)))
    rows, columns = np.nonzero(_is_usable(frame.depth, max_depth))
    if not len(rows):
        return None
    nearest = int(np.argmin((rows - row) ** 2 + (columns - column) ** 2))
    v, u = int(rows[nearest]), int(columns[nearest])
    return _world_point(frame, u, v, float(frame.depth[v, u]))


def _is_usable(depth: NDArray[np.floating], max_depth: float) -> NDArray[np.bool_]:
    return np.asarray(np.isfinite(depth) & (depth > 0.0) & (depth <= max_depth))


def _world_point(frame: Frame, u: float, v: float, depth: float) -> NDArray[np.float64]:
    camera = frame.intrinsics
    ray = np.array([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0])
    return np.asarray(frame.T_world_camera[:3, :3] @ (depth * ray) + frame.camera_centre)
