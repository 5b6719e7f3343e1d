# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a frame that cannot be fused is good for: light alone, or a refusal that says why."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.capture.pose import FURTHEST
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.fusion.frames.depth_unit import CHECK, mistake_of, unit_hint
from reflest_core.fusion.frames.region import Region
from reflest_core.fusion.settings import FusionSettings
from reflest_core.jit import compiled, kernel_array
from reflest_core.surface.voxel_key import VOXEL_LIMIT

LAST_STAMP_NS = 2**63 - 1
"""Stamps are kept as 64-bit integers."""
MOST_POSITIONS = 4096
"""Voxels at most that stand for the surface."""
MARGIN = 0.1
"""Of the image's size: so near to its edge the surface counts as in sight."""


@dataclass(frozen=True)
class KnownSurface:
    """What was scanned so far.

    Attributes:
        positions: (V, 3) float32, some of its surface voxels, world frame, metres.
    """

    positions: NDArray[np.float32]

    @staticmethod
    def of(positions: NDArray[np.float32]) -> KnownSurface:
        """Thin the surface to :data:`MOST_POSITIONS` or a few more.

        Args:
            positions: (N, 3) all surface voxels, at least one.

        Returns:
            The thinned surface.
        """
        return KnownSurface(positions[:: max(len(positions) // MOST_POSITIONS, 1)])

    @property
    def centre(self) -> NDArray[np.float64]:
        """(3,) mean position, world frame, metres."""
        return self._moments[0]

    @property
    def radius(self) -> float:
        """Root mean square distance from the centre, metres."""
        return math.sqrt(self._moments[1])

    @cached_property
    def _moments(self) -> tuple[NDArray[np.float64], float]:
        return _mean_and_variance(kernel_array(self.positions, np.float32))

    def is_in_sight(self, frame: Frame) -> bool:
        """Decide whether any of it lies in a frame's field of view, hidden or not.

        Args:
            frame: The frame.

        Returns:
            Whether some does, or nearly.
        """
        camera, T = frame.intrinsics, frame.T_world_camera
        x, y, z = ((self.positions - T[:3, 3]) @ T[:3, :3]).T
        before = z > 0.0
        u = camera.fx * x[before] / z[before] + camera.cx
        v = camera.fy * y[before] / z[before] + camera.cy
        across, down = MARGIN * camera.width, MARGIN * camera.height
        inside = (u > -across) & (u < camera.width + across)
        return bool((inside & (v > -down) & (v < camera.height + down)).any())


@compiled
def _mean_and_variance(positions: NDArray[np.float32]) -> tuple[NDArray[np.float64], float]:
    """Mean (3,) of positions (V, 3), and their mean squared distance from it."""
    mean, squares = np.zeros(3), np.zeros(3)
    for voxel in range(len(positions)):
        for axis in range(3):
            mean[axis] += positions[voxel, axis]
    mean /= len(positions)
    for voxel in range(len(positions)):
        for axis in range(3):
            squares[axis] += (positions[voxel, axis] - mean[axis]) ** 2
    squares /= len(positions)
    return mean, squares[0] + squares[1] + squares[2]


NEAREST_LIKELY = 0.02
"""Metres; depth that is nearer everywhere is not fused."""

WINDOW, NEAR_DECADE = 0.05, 0.15
"""Half edge, in edges of the image, of where depth is compared with the region's distance, and by
which its decimal logarithm may differ from a whole number."""

ROTATION_TOLERANCE = 0.05
"""By which the products of a rotation's columns may differ from those of unit vectors."""


def check_frame_pose(frame: Frame) -> None:
    """Refuse a frame whose pose is none, or farther from the world's origin than scans reach.

    Args:
        frame: The frame, in the world frame.

    Raises:
        FrameRefused: ``POSE_INVALID``.
    """
    pose = frame.T_world_camera
    if not np.isfinite(pose).all():
        raise FrameRefused(
            RefusalCause.POSE_INVALID,
            "the pose holds NaN or infinity: check that the tracker has not lost its track",
        )
    if np.abs(frame.camera_centre).max() >= FURTHEST:
        raise FrameRefused(
            RefusalCause.POSE_INVALID,
            f"the camera lies {FURTHEST:.0e} m or more from the origin: check the tracker's units",
        )
    rotation = pose[:3, :3]
    if np.abs(rotation.T @ rotation - np.eye(3)).max() > ROTATION_TOLERANCE:
        raise FrameRefused(
            RefusalCause.POSE_INVALID,
            "the pose's rotation is not orthonormal: check the pose's publisher",
        )


def check_reach(frame: Frame, settings: FusionSettings) -> None:
    """Refuse a frame that is farther away than the keys of voxels reach.

    Args:
        frame: The frame, in the scan's coordinates.
        settings: Of the scan.

    Raises:
        FrameRefused: ``POSE_INVALID``, with the distance.
    """
    limit = VOXEL_LIMIT * settings.voxel_size - settings.max_depth
    away = float(np.abs(frame.camera_centre).max())
    if away > limit:
        raise FrameRefused(
            RefusalCause.POSE_INVALID,
            f"the camera is {away / 1000:.1f} km from where the scan began, and voxels of "
            f"{settings.voxel_size:g} m reach {limit / 1000:.1f} km: reset the scan to begin here, "
            "or raise fusion.voxel_size",
        )


def check_stamp(frame: Frame, last_ns: int | None) -> None:
    """Refuse a frame whose stamp is no time, or not after the last one.

    Args:
        frame: The frame.
        last_ns: Stamp of the last fused frame, nanoseconds; None takes any.

    Raises:
        FrameRefused: ``STAMP_INVALID``, ``TIME_BACKWARDS``.
    """
    if not abs(frame.stamp_ns) < LAST_STAMP_NS:
        raise FrameRefused(
            RefusalCause.STAMP_INVALID,
            f"the image stamp is {frame.stamp_ns / 1e9:.4g} s: expected a time within 292 years "
            "of 0",
        )
    if last_ns is not None and frame.stamp_ns <= last_ns:
        raise FrameRefused(
            RefusalCause.TIME_BACKWARDS,
            f"the image stamp {frame.stamp_ns} ns is not after the last fused one "
            f"({last_ns} ns): reset the scan if the clock or the bag was restarted",
        )


def refusal_without_surface(
    frame: Frame, region: Region, settings: FusionSettings, work_radius: float
) -> FrameRefused:
    """Explain why a frame without a pixel of the surface is of no use.

    Args:
        frame: The frame.
        region: The region of interest.
        settings: ``max_depth`` is named.
        work_radius: Metres; 0 where there is no work sphere yet.

    Returns:
        The refusal, to be raised.
    """
    if not np.any(np.isfinite(frame.depth) & (frame.depth > 0.0)):
        return FrameRefused(
            RefusalCause.DEPTH_EMPTY,
            f"{frame.depth_source} at {frame.stamp_ns / 1e9:.3f} s has no valid pixel (all are 0, "
            "not finite, or saturated: 65535 in 16 bits): move the camera into its depth range, or "
            "check the depth topic's encoding and unit",
        )
    within = f"within max_depth = {settings.max_depth:g} m"
    if frame.mask is not None:
        sentence = f"no pixel of the mask has clear depth {within}: check the mask topic"
    elif region.shape:
        sentence = (
            f"no depth {within} lies in the region of interest: check the region's centre "
            f"and size and the pose's frame{_scale_hint(frame, region)}"
        )
    elif work_radius > 0.0 and _shows_depth(frame, settings.max_depth):
        sentence = (
            f"no depth {within} lies within {work_radius:.2g} m of the scan's centre: move back to "
            "what was scanned first, raise work_radius or reset the scan"
        )
    elif np.max(frame.depth, initial=0.0, where=np.isfinite(frame.depth)) < NEAREST_LIKELY:
        sentence = f"no depth is {NEAREST_LIKELY:g} m or more"
    elif _shows_depth(frame, settings.max_depth):
        sentence = (
            f"no depth {within} is free of depth edges: lower fusion.depth_edge_margin, or see "
            "that depth is dense where the surface is"
        )
    else:
        sentence = f"no depth lies {within}: raise max_depth or move closer"
    return FrameRefused(
        RefusalCause.NO_OVERLAP, f"{sentence}; {_depth_seen(frame, settings.max_depth)}"
    )


def _scale_hint(frame: Frame, region: Region) -> str:
    """Name the depth's unit where depth over the region's distance is near a power of ten."""
    centre = frame.T_world_camera[:3, :3].T @ (region.centre - frame.camera_centre)
    camera, distance = frame.intrinsics, float(centre[2])
    if not distance > 0.0:
        return ""
    column = camera.fx * centre[0] / distance + camera.cx
    row = camera.fy * centre[1] / distance + camera.cy
    reach = WINDOW * max(camera.width, camera.height)
    low, left = (max(round(at - reach), 0) for at in (row, column))
    high, right = (max(round(at + reach), 0) for at in (row, column))
    depth = frame.depth[low:high, left:right]
    known = depth[np.isfinite(depth) & (depth > 0.0)]
    if not len(known):
        return ""
    decades = math.log10(float(np.median(known)) / distance)
    if round(decades) == 0 or abs(decades - round(decades)) > NEAR_DECADE:
        return ""
    factor = 10.0 ** round(decades)
    likely = mistake_of(factor)
    return (
        f"; depth there is about {factor:g} times the region's distance of {distance:.3g} m: "
        f"{f'it seems to be {likely}' if likely else CHECK}"
    )


def _depth_seen(frame: Frame, max_depth: float) -> str:
    """Say what depth there is, and where its unit cannot be right, which is likely."""
    valid = frame.depth[np.isfinite(frame.depth) & (frame.depth > 0.0)]
    least, median, most = (float(value) for value in np.quantile(valid, (0.0, 0.5, 1.0)))
    seen = f"depth is {least:.3g} to {most:.3g} m, its median {median:.3g} m"
    hint = unit_hint(median, max_depth)
    return f"{seen}: {hint}" if hint else seen


def _shows_depth(frame: Frame, max_depth: float) -> bool:
    return bool(np.any((frame.depth > 0.0) & (frame.depth <= max_depth)))
