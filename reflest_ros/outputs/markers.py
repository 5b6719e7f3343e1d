# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflectance/markers``: the values as text at the object, the keyframes' cameras around it."""

from __future__ import annotations

import itertools
import math
from collections import deque

import numpy as np
from geometry_msgs.msg import Point
from numpy.typing import NDArray
from rclpy.node import Node
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from reflest_core.estimation.estimate import BrdfEstimate, EstimateStatus
from reflest_core.estimation.pipeline import KeyframeSnapshot
from reflest_core.fusion.frames.region import RegionShape
from reflest_core.fusion.settings import RegionSettings
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_ros.inputs.core_messages import ns_to_stamp
from reflest_ros.outputs.view_publisher import ViewPublisher
from reflest_ros.outputs.view_settings import MOST_KEYFRAMES, MarkerSettings, read_settings

Pose = NDArray[np.float64]

TRUSTED, UNCERTAIN = (0.75, 0.95, 0.75), (1.0, 0.75, 0.3)
OLDEST, NEWEST = np.array([0.25, 0.3, 0.55]), np.array([1.0, 0.6, 0.1])

GLASS, GLASS_ALPHA = (0.5, 0.7, 1.0), 0.12

CIRCLE_PARTS, CIRCLE_WIDTH = 48, 0.005
"""Of the circles that show the work radius: edges, and their width over the radius."""

HALF_WIDTH, HALF_HEIGHT = 0.6, 0.45
"""Of a pyramid over its length; the camera's own angles are not shown."""

EDGES = ((0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (2, 3), (3, 4), (4, 1))
"""Of a pyramid: pairs out of its tip (0) and the corners of its base."""


class Markers:
    """Publishes the markers; see :class:`reflest_ros.outputs.estimate_output.EstimateView`."""

    def __init__(self, node: Node) -> None:
        """Create the publishers.

        Args:
            node: publishes.
        """
        self._node = node
        self._publisher = ViewPublisher(node, MarkerArray, "reflectance/markers")
        self._poses: deque[Pose] = deque(maxlen=MOST_KEYFRAMES)

    def show(self, keyframe: KeyframeSnapshot, estimate: BrdfEstimate | None) -> None:
        """Remember the pose; show text and cameras.

        Args:
            keyframe: the scan that it belongs to.
            estimate: the keyframe's estimate; None where there is none.
        """
        pose = keyframe.T_world_camera
        # A request for an estimate shows the last keyframe again.
        if pose is not None and not (self._poses and np.array_equal(self._poses[-1], pose)):
            self._poses.append(pose)
        # A copy, for the message may be made in another thread while keyframes come.
        poses = list(self._poses)
        self._publisher.show(lambda: self._message(keyframe, estimate, poses))

    def clear(self) -> None:
        """Remove all markers."""
        self._poses.clear()
        self._publisher.replace(MarkerArray(markers=[Marker(action=Marker.DELETEALL)]))

    def destroy(self) -> None:
        """Destroy the publisher."""
        self._publisher.destroy()

    def _message(
        self, keyframe: KeyframeSnapshot, estimate: BrdfEstimate | None, poses: list[Pose]
    ) -> MarkerArray:
        settings = read_settings(self._node, "markers", MarkerSettings)
        region = read_settings(self._node, "region", RegionSettings)
        up = np.array(self._node.get_parameter("estimation.up").value)
        return marker_message(keyframe, estimate, poses, settings, region, up)


def marker_message(
    keyframe: KeyframeSnapshot,
    estimate: BrdfEstimate | None,
    poses: list[Pose],
    settings: MarkerSettings,
    region: RegionSettings,
    up: NDArray[np.float64],
) -> MarkerArray:
    """Text above the surface (namespace ``values``), pyramids for ``poses`` (``keyframes``).

    The region of interest is a glass body (``region``); without one, three circles show the work
    radius, outside of which nothing is scanned (``work_radius``). ``poses``: ``T_world_camera``
    (4, 4), oldest first. ``up``: (3,), in the world frame.

    Args:
        keyframe: the scan that it belongs to.
        estimate: the keyframe's estimate.
        poses: camera poses, (4, 4) each.
        settings: the parameters.
        region: of interest.
        up: (3,) unit.
    """
    shown = poses[max(len(poses) - settings.max_keyframes, 0) :]
    markers = [
        _values(keyframe.surface, estimate, up),
        _cameras(shown, settings.frustum),
        _region(region),
        _work_radius(keyframe),
    ]
    for marker in markers:
        marker.header.stamp = ns_to_stamp(keyframe.stamp_ns)
        marker.header.frame_id = keyframe.world_frame_id
    return MarkerArray(markers=markers)


def _values(
    surface: ObservedSurface, estimate: BrdfEstimate | None, up: NDArray[np.float64]
) -> Marker:
    marker = Marker(ns="values", id=0, type=Marker.TEXT_VIEW_FACING)
    if surface.voxel_count == 0:
        marker.action = Marker.DELETE
        return marker
    positions = surface.world_positions
    lowest, highest = positions.min(axis=0), positions.max(axis=0)
    size = float(np.linalg.norm(highest - lowest))
    marker.scale.z = float(np.clip(0.06 * size, 0.005, 0.5))
    # The lines, which are centred on this point, stand clear of the object's top.
    upwards = up / np.linalg.norm(up)
    height = float(np.abs(upwards) @ (highest - lowest)) / 2
    at = (lowest + highest) / 2 + upwards * (height + 4 * marker.scale.z)
    marker.pose.position = _point(at)
    marker.pose.orientation.w = 1.0
    is_trusted = estimate is not None and estimate.status is EstimateStatus.OK
    marker.color = _colour(TRUSTED if is_trusted else UNCERTAIN)
    marker.text = estimate_text(estimate)
    return marker


def _cameras(poses: list[Pose], length: float) -> Marker:
    marker = Marker(ns="keyframes", id=0, type=Marker.LINE_LIST)
    if not poses:
        marker.action = Marker.DELETE
        return marker
    marker.scale.x = 0.03 * length
    marker.pose.orientation.w = 1.0
    marker.color = _colour((1.0, 1.0, 1.0))
    for age, pose in zip(np.linspace(0, 1, len(poses)), poses, strict=True):
        colour = _colour(NEWEST if len(poses) == 1 else OLDEST + age * (NEWEST - OLDEST))
        corners = [_point(corner) for corner in camera_pyramid(pose, length)]
        for edge in EDGES:
            marker.points += [corners[edge[0]], corners[edge[1]]]
            marker.colors += [colour, colour]
    return marker


def _region(region: RegionSettings) -> Marker:
    marker = Marker(ns="region", id=0)
    if region.shape == "none":
        marker.action = Marker.DELETE
        return marker
    is_box = region.shape == "box"
    marker.type = Marker.CUBE if is_box else Marker.SPHERE
    marker.pose.position = _point(np.array(region.centre))
    marker.pose.orientation.w = 1.0
    # A sphere's diameter is the first value.
    edges = region.size if is_box else (region.size[0],) * 3
    marker.scale.x, marker.scale.y, marker.scale.z = edges
    marker.color = _colour(GLASS)
    marker.color.a = GLASS_ALPHA
    return marker


def _work_radius(keyframe: KeyframeSnapshot) -> Marker:
    """Great circles of the work sphere; a body would veil what is in it."""
    marker = Marker(ns="work_radius", id=0, type=Marker.LINE_LIST)
    bounds = keyframe.bounds
    is_sphere = bounds is not None and bounds.shape is RegionShape.SPHERE
    if bounds is None or not is_sphere or keyframe.memory is None:
        marker.action = Marker.DELETE
        return marker
    radius = float(bounds.half_size[0])
    marker.scale.x = CIRCLE_WIDTH * radius
    marker.pose.orientation.w = 1.0
    marker.color = _colour(GLASS)
    marker.color.a = 0.5
    angles = np.linspace(0.0, 2.0 * np.pi, CIRCLE_PARTS + 1)
    across, along = radius * np.cos(angles), radius * np.sin(angles)
    for axis in range(3):
        circle = np.tile(bounds.centre, (len(angles), 1))
        circle[:, (axis + 1) % 3] += across
        circle[:, (axis + 2) % 3] += along
        points = [_point(one) for one in circle]
        marker.points += [end for pair in itertools.pairwise(points) for end in pair]
    return marker


def camera_pyramid(T_world_camera: Pose, length: float) -> NDArray[np.float64]:
    """Tip and base (5, 3), world frame; the base lies ``length`` metres along the optical axis.

    Args:
        T_world_camera: (4, 4) pose of the camera.
        length: metres.
    """
    across, down = HALF_WIDTH * length, HALF_HEIGHT * length
    in_camera = np.array(
        [
            [0.0, 0.0, 0.0],
            [-across, -down, length],
            [across, -down, length],
            [across, down, length],
            [-across, down, length],
        ]
    )
    in_world: NDArray[np.float64] = in_camera @ T_world_camera[:3, :3].T + T_world_camera[:3, 3]
    return in_world


def _point(position: NDArray[np.floating]) -> Point:
    x, y, z = position.tolist()
    return Point(x=x, y=y, z=z)


def _colour(rgb: tuple[float, float, float] | NDArray[np.float64]) -> ColorRGBA:
    red, green, blue = map(float, rgb)
    return ColorRGBA(r=red, g=green, b=blue, a=1.0)


def estimate_text(estimate: BrdfEstimate | None) -> str:
    """Write an estimate in a few short lines, for a display.

    Args:
        estimate: None where there is none yet.

    Returns:
        Values, standard deviations where they are known, coverage and warnings.
    """
    if estimate is None:
        return "no estimate yet: scan more of the object"
    red, green, blue = estimate.rho_d
    lines = [
        f"rho_d  {red:.3f} {green:.3f} {blue:.3f}{_deviation(max(estimate.rho_d_stddev))}",
        f"rho_s  {estimate.rho_s:.3f}{_deviation(estimate.rho_s_stddev)}",
        f"alpha  {estimate.alpha:.3f}{_deviation(estimate.alpha_stddev)}",
        f"{estimate.coverage:.0%} of directions, {estimate.view_count} views",
    ]
    if estimate.status is not EstimateStatus.OK:
        lines += f"{estimate.status.name}: {estimate.status_text}".split("; ")
    return "\n".join(lines)


def _deviation(stddev: float) -> str:
    return "" if math.isnan(stddev) else f" ± {stddev:.3f}"
