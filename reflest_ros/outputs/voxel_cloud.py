# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflectance/voxels``: the observed surface as a coloured point cloud."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rclpy.node import Node
from sensor_msgs.msg import PointCloud2

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.pipeline import KeyframeSnapshot
from reflest_core.rendering.voxel_colours import (
    UNKNOWN,
    VoxelColouring,
    estimate_colours,
    observed_colours,
    view_count_colours,
)
from reflest_ros.outputs.point_cloud import far_points, packed_colours, point_cloud
from reflest_ros.outputs.view_publisher import ViewPublisher
from reflest_ros.outputs.view_settings import VoxelSettings, read_settings

POINT = np.dtype(
    [
        ("x", np.float32),
        ("y", np.float32),
        ("z", np.float32),
        ("rgb", np.uint32),
        ("normal_x", np.float32),
        ("normal_y", np.float32),
        ("normal_z", np.float32),
        ("views", np.float32),
    ]
)
"""A point of ``reflectance/voxels``; ``rgb`` as :data:`.COLOUR` says. Where the scan has an origin
of its own, ``x``, ``y`` and ``z`` are float64."""


class VoxelCloud:
    """Publishes the cloud; see :class:`reflest_ros.outputs.estimate_output.EstimateView`."""

    def __init__(self, node: Node) -> None:
        """Create the publishers.

        Args:
            node: publishes.
        """
        self._node = node
        self._publisher = ViewPublisher(node, PointCloud2, "reflectance/voxels")
        self._frame_id = ""

    @property
    def is_watched(self) -> bool:
        """Whether anyone subscribes to the cloud."""
        return self._publisher.is_watched

    def show(self, keyframe: KeyframeSnapshot, estimate: BrdfEstimate | None) -> None:
        """Show the surface at a keyframe.

        Args:
            keyframe: the scan that it belongs to.
            estimate: the keyframe's estimate.
        """
        self._frame_id = keyframe.world_frame_id
        self._publisher.show(lambda: self._message(keyframe, estimate))

    def clear(self) -> None:
        """Replace the last cloud, which stays readable, by one without points."""
        self._publisher.replace(point_cloud(np.zeros(0, POINT), self._frame_id, 0))

    def destroy(self) -> None:
        """Destroy the publisher."""
        self._publisher.destroy()

    def _message(self, keyframe: KeyframeSnapshot, estimate: BrdfEstimate | None) -> PointCloud2:
        settings = read_settings(self._node, "voxels", VoxelSettings)
        most_views = self._node.get_parameter("fusion.observations_per_voxel").value
        return cloud_message(keyframe, estimate, settings, most_views)


def cloud_message(
    keyframe: KeyframeSnapshot,
    estimate: BrdfEstimate | None,
    settings: VoxelSettings,
    most_views: int,
) -> PointCloud2:
    """At most ``settings.max_points`` voxels, evenly from the whole, in the world frame, metres.

    ``views`` is the number of observations of a voxel, at most ``most_views``.

    Args:
        keyframe: the scan that it belongs to.
        estimate: the keyframe's estimate.
        settings: the parameters.
        most_views: views that give the brightest colour of the map.
    """
    surface = keyframe.surface
    counts = surface.observation_counts
    far = surface.origin.any()
    points = np.zeros(surface.voxel_count, far_points(POINT) if far else POINT)
    positions = surface.world_positions
    for axis, name in enumerate("xyz"):
        points[name] = positions[:, axis]
        points[f"normal_{name}"] = surface.normals[:, axis]
    points["views"] = counts
    points["rgb"] = packed_colours(_colours(keyframe, estimate, settings, most_views))
    if len(points) > settings.max_points:
        points = points[np.linspace(0, len(points) - 1, settings.max_points).astype(np.int64)]
    return point_cloud(points, keyframe.world_frame_id, keyframe.stamp_ns)


def _colours(
    keyframe: KeyframeSnapshot,
    estimate: BrdfEstimate | None,
    settings: VoxelSettings,
    most_views: int,
) -> NDArray[np.uint8]:
    surface = keyframe.surface
    colouring = VoxelColouring(settings.colour)
    if colouring is VoxelColouring.OBSERVED:
        return observed_colours(surface)
    if colouring is VoxelColouring.VIEWS:
        return view_count_colours(surface.observation_counts, most_views)
    if estimate is None or keyframe.T_world_camera is None:
        return np.full((surface.voxel_count, 3), UNKNOWN, np.uint8)
    eye = keyframe.T_world_camera[:3, 3] - surface.origin
    return estimate_colours(surface, estimate.ward, eye)
