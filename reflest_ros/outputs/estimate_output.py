# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where estimates go: the topic, the views, and the counts that the diagnostics show."""

from __future__ import annotations

import dataclasses
import math
import time
from dataclasses import dataclass

from rclpy.node import Node

from reflest_core.errors import ReflestError
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_ros.inputs.qos import OUTPUT_QOS
from reflest_ros.msg import BrdfEstimate as BrdfEstimateMessage
from reflest_ros.outputs.estimate_message import estimate_to_message
from reflest_ros.outputs.estimate_view import EstimateView
from reflest_ros.workers.fusion_worker import Keyframe


@dataclass
class EstimateCounts:
    """What became of the keyframes. ``last_time``: ``time.monotonic``; NaN where none was."""

    published: int = 0
    failed: int = 0
    last_failure: str = ""
    last_latency: float = math.nan
    last_time: float = math.nan


class EstimateOutput:
    """Publishes estimates; driven by the estimation worker, which runs one method at a time."""

    def __init__(self, node: Node, views: list[EstimateView]) -> None:
        self.counts = EstimateCounts()
        self._node = node
        self._views = views
        self._publisher = node.create_publisher(BrdfEstimateMessage, "reflectance/brdf", OUTPUT_QOS)

    @property
    def topic(self) -> str:
        """The full name of the estimates' topic."""
        name: str = self._publisher.topic_name
        return name

    def publish(self, keyframe: Keyframe, estimate: BrdfEstimate) -> BrdfEstimate:
        """Send the estimate of ``keyframe``; return it with its latency."""
        estimate = dataclasses.replace(estimate, latency=time.monotonic() - keyframe.arrival)
        if self.counts.published == 0:
            self._node.get_logger().info(f"first estimate after {estimate.view_count} views")
        self._publisher.publish(estimate_to_message(estimate))
        self.counts.published += 1
        self.counts.last_latency = estimate.latency
        self.counts.last_time = time.monotonic()
        for view in self._views:
            view.show(keyframe.snapshot, estimate)
        return estimate

    def fail(self, keyframe: Keyframe, error: ReflestError) -> None:
        """Count a keyframe that gave no estimate, and show the little there is."""
        if self.counts.failed == 0:
            self._node.get_logger().warning(f"no estimate at a keyframe: {error} (said once)")
        self.counts.failed += 1
        self.counts.last_failure = str(error)
        for view in self._views:
            view.show(keyframe.snapshot, None)

    def clear(self) -> None:
        """Empty the views; the estimate on the topic stays until the next one."""
        for view in self._views:
            view.clear()

    def destroy(self) -> None:
        """Give the publishers back."""
        for view in self._views:
            view.destroy()
        self._node.destroy_publisher(self._publisher)
