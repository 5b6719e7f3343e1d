# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How well depth maps from views far apart meet, under other intrinsics and another scale.

Neighbouring views meet nearly as well under wrong intrinsics, for they are distorted alike. Views
that are 30 degrees apart do not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.poses.agreement import DepthSample, depth_tolerance
from reflest_core.jit import compiled

COLUMNS = 160
"""Columns of a reduced depth map, about."""
SAMPLES = 250
"""Samples of a view that are compared with another one, about."""
MOST_PAIRS = 24
MOST_TURN = math.radians(60.0)
"""Views further apart show too little of the same surface."""
FEWEST = 30
"""With fewer samples in sight of both views a pair says nothing."""
UNIT = 0.5
"""Distance that costs half, in tolerances of depth (:func:`.depth_tolerance`)."""
SMOOTH = 0.05
"""Relative range of four neighbouring depths up to which they are interpolated."""


@dataclass(frozen=True)
class Reading:
    """Other intrinsics, positions and mounting than the given ones.

    Attributes:
        focal: Factor on the focal lengths.
        right: The centre's shift along x as a share of the given focal length.
        down: The same along y.
        scale: Factor on the positions.
        x: The optical frame's place in the frame whose pose was given, metres.
        y: The same, down.
        z: The same, forward.
    """

    focal: float = 1.0
    right: float = 0.0
    down: float = 0.0
    scale: float = 1.0
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


class View:
    """A reduced depth map with its pose and a sample of its pixels.

    Attributes:
        depth: (h, w) float32 metres, 0 where unknown.
        pinhole: fx, fy, cx, cy of the reduced map, pixels.
        rays: (N, 3) x and y at unit depth, and depth, metres, of the sampled pixels.
        pose: (4, 4) ``T_world_camera``.
    """

    def __init__(self, sample: DepthSample) -> None:
        """Reduce a frame's depth map.

        Args:
            sample: The depth map with its pose and intrinsics.
        """
        step = max(sample.depth.shape[1] // COLUMNS, 1)
        first = step // 2
        self.depth = np.ascontiguousarray(sample.depth[first::step, first::step])
        fx, fy, cx, cy = sample.pinhole.tolist()
        self.pinhole = np.array([fx, fy, cx - first, cy - first]) / step
        self.rays = np.ascontiguousarray(sample.rays[:: max(sample.size // SAMPLES, 1)])
        self.pose = sample.pose


@dataclass(frozen=True)
class Meeting:
    """How well pairs of views meet.

    Attributes:
        costs: (P,) mean cost of each pair, 0 where it meets exactly, 1 where it does not at all.
        shares: (P,) share of samples nearer than half the tolerance.
    """

    costs: NDArray[np.float64]
    shares: NDArray[np.float64]

    @property
    def cost(self) -> float:
        """Mean cost of the pairs."""
        return float(self.costs.mean())


class ViewPairs:
    """Pairs of views that see the same surface from up to 60 degrees apart."""

    def __init__(self, views: Sequence[View]) -> None:
        """Choose the pairs.

        Args:
            views: In their order.
        """
        self._views = _ViewTable.of(views)
        later, earlier = np.tril_indices(len(views), -1)
        poses = np.stack([view.pose for view in views])
        relative = np.linalg.inv(poses)[earlier] @ poses[later]
        cosine = (np.trace(relative[:, :3, :3], axis1=1, axis2=2) - 1.0) / 2.0
        turns = np.arccos(np.clip(cosine, -1.0, 1.0))
        near = np.flatnonzero(turns < MOST_TURN)
        near = near[np.argsort(turns[near], kind="stable")]
        count = min(MOST_PAIRS, len(near))
        near = near[np.unique(np.linspace(0, len(near) - 1, count).astype(int))]
        self._views_of_pairs = np.stack([later[near], earlier[near]], axis=1)
        self._relative = np.ascontiguousarray(relative[near])
        if len(near):
            is_known = self._compared(Reading(), 1)[:, 2] >= FEWEST
            self._views_of_pairs = self._views_of_pairs[is_known]
            self._relative = self._relative[is_known]

    def __len__(self) -> int:
        """Return the number of pairs."""
        return len(self._relative)

    def meet(self, reading: Reading, stride: int = 1) -> Meeting:
        """Compare all pairs.

        Args:
            reading: Intrinsics and scale to read them with.
            stride: Compare every so many samples alone.
        """
        found = self._compared(reading, stride)
        count = np.maximum(found[:, 2], 1.0)
        # What has moved out of sight must not look like what meets.
        is_seen = found[:, 2] * stride >= FEWEST
        return Meeting(
            np.where(is_seen, found[:, 0] / count, 1.0), np.where(is_seen, found[:, 1] / count, 0.0)
        )

    def _compared(self, reading: Reading, stride: int) -> NDArray[np.float64]:
        """(P, 3) summed cost, samples that are near, and samples in sight of both views."""
        place = np.array([reading.x, reading.y, reading.z])
        moved = self._relative.copy()
        moved[:, :3, 3] = moved[:, :3, :3] @ place + reading.scale * moved[:, :3, 3] - place
        values = reading.focal, reading.right, reading.down
        views = self._views
        arrays = views.rays, views.first, views.depth, views.sizes, views.pinholes
        return _compared_pairs(self._views_of_pairs, moved, *arrays, *values, stride)


@dataclass(frozen=True)
class _ViewTable:
    """Views in arrays, as the kernel reads them.

    Attributes:
        rays: (R, 3) all views' rays.
        first: (V + 1,) the row of each view's first one, and their number.
        depth: (V, h, w) the depth maps, 0 beyond the size of a smaller one.
        sizes: (V, 2) rows and columns of each.
        pinholes: (V, 4).
    """

    rays: NDArray[np.float64]
    first: NDArray[np.int64]
    depth: NDArray[np.float32]
    sizes: NDArray[np.int64]
    pinholes: NDArray[np.float64]

    @staticmethod
    def of(views: Sequence[View]) -> _ViewTable:
        sizes = np.array([view.depth.shape for view in views], np.int64)
        depth = np.zeros((len(views), *sizes.max(axis=0)), np.float32)
        for there, view in zip(depth, views, strict=True):
            there[: view.depth.shape[0], : view.depth.shape[1]] = view.depth
        return _ViewTable(
            np.concatenate([view.rays for view in views]),
            np.cumsum([0, *(len(view.rays) for view in views)]),
            depth,
            sizes,
            np.stack([view.pinhole for view in views]),
        )


@compiled
def _compared_pairs(
    pairs: NDArray[np.int64],
    transforms: NDArray[np.float64],
    rays: NDArray[np.float64],
    first: NDArray[np.int64],
    depth: NDArray[np.float32],
    sizes: NDArray[np.int64],
    pinholes: NDArray[np.float64],
    focal: float,
    right: float,
    down: float,
    stride: int,
) -> NDArray[np.float64]:
    found = np.empty((len(pairs), 3))
    for index in range(len(pairs)):
        later, earlier = pairs[index]
        found[index, 0], found[index, 1], found[index, 2] = _compared(
            rays[first[later] : first[later + 1]],
            transforms[index],
            depth[earlier, : sizes[earlier, 0], : sizes[earlier, 1]],
            pinholes[earlier],
            focal,
            right,
            down,
            stride,
        )
    return found


@compiled
def _compared(
    rays: NDArray[np.float64],
    transform: NDArray[np.float64],
    depth: NDArray[np.float32],
    pinhole: NDArray[np.float64],
    focal: float,
    right: float,
    down: float,
    stride: int,
) -> tuple[float, int, int]:
    """Return the summed cost, how many samples are near, and how many are in sight of both."""
    fx, fy, cx, cy = pinhole[0] * focal, pinhole[1] * focal, pinhole[2], pinhole[3]
    cx += pinhole[0] * right
    cy += pinhole[1] * down
    height, width = depth.shape
    number = (len(rays) + stride - 1) // stride
    ahead, columns, rows = np.empty(number), np.empty(number), np.empty(number)
    for n in range(number):  # without branches, for vector instructions
        z = rays[n * stride, 2]
        x = (rays[n * stride, 0] - right) * (z / focal)
        y = (rays[n * stride, 1] - down) * (z / focal)
        away = transform[2, 0] * x + transform[2, 1] * y + transform[2, 2] * z
        away += transform[2, 3]
        across = transform[0, 0] * x + transform[0, 1] * y + transform[0, 2] * z
        along = transform[1, 0] * x + transform[1, 1] * y + transform[1, 2] * z
        ahead[n] = away
        columns[n] = fx * ((across + transform[0, 3]) / away) + cx
        rows[n] = fy * ((along + transform[1, 3]) / away) + cy
    cost, near, count = 0.0, 0, 0
    for n in range(number):
        away, column, row = ahead[n], columns[n], rows[n]
        is_inside = (away > 0.0) & (column >= 0.0) & (column < width - 1)
        if not (is_inside & (row >= 0.0) & (row < height - 1)):
            continue
        there = _depth_at(depth, row, column)
        if not there > 0.0:
            continue
        distance, unit = away - there, UNIT * depth_tolerance(there)
        cost += distance * distance / (distance * distance + unit * unit)
        near += 1 if abs(distance) < unit else 0
        count += 1
    return cost, near, count


@compiled
def _depth_at(depth: NDArray[np.float32], row: float, column: float) -> float:
    """Interpolate where the surface is smooth, else take the nearest; 0 beside a gap."""
    y, x = int(row), int(column)
    least = greatest = np.float64(depth[y, x])
    for there in (depth[y, x + 1], depth[y + 1, x], depth[y + 1, x + 1]):
        least, greatest = min(least, np.float64(there)), max(greatest, np.float64(there))
    if not (least > 0.0 and greatest < np.inf):
        return 0.0
    if greatest - least > SMOOTH * least:
        return float(depth[int(row + 0.5), int(column + 0.5)])
    down, right = row - y, column - x
    above = depth[y, x] * (1.0 - right) + depth[y, x + 1] * right
    below = depth[y + 1, x] * (1.0 - right) + depth[y + 1, x + 1] * right
    return float(above * (1.0 - down) + below * down)
