"""The views that the node publishes."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node

from reflest_ros.estimate_view import EstimateView

VIEWS: tuple[Callable[[Node], EstimateView], ...] = ()
