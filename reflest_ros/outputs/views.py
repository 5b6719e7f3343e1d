# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The views that the node publishes."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node

from reflest_ros.outputs.environment import Environment
from reflest_ros.outputs.estimate_view import EstimateView
from reflest_ros.outputs.markers import Markers
from reflest_ros.outputs.preview import Preview
from reflest_ros.outputs.voxel_cloud import VoxelCloud

VIEWS: tuple[Callable[[Node], EstimateView], ...] = (Preview, VoxelCloud, Environment, Markers)
