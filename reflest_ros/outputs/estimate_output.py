# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Where estimates go: the topic, the views, and the counts that the diagnostics show."""

from __future__ import annotations

import dataclasses
import math
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from rclpy.node import Node

from reflest_core.errors import ReflestError
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.pipeline import KeyframeSnapshot
from reflest_ros.inputs.qos import OUTPUT_QOS
from reflest_ros.msg import BrdfEstimate as BrdfEstimateMessage
from reflest_ros.outputs.environment import Environment
from reflest_ros.outputs.estimate_message import estimate_to_message, unknown_message
from reflest_ros.outputs.markers import Markers
from reflest_ros.outputs.material_output import MaterialOutput
from reflest_ros.outputs.preview import Preview
from reflest_ros.outputs.voxel_cloud import VoxelCloud
from reflest_ros.workers.fusion_worker import Keyframe


class EstimateView(Protocol):
    """A publisher that shows the state of a scan; made at configure, destroyed at cleanup.

    No two methods run at once.
    """

    def show(self, keyframe: KeyframeSnapshot, estimate: BrdfEstimate | None) -> None:
        """Publish the state at a keyframe, in the estimation thread.

        ``estimate`` is None where the keyframe shows too little for one.

        Args:
            keyframe: the scan that it belongs to.
            estimate: the keyframe's estimate.
        """

    def clear(self) -> None:
        """Replace what was shown by nothing: a new scan begins."""

    def destroy(self) -> None:
        """Destroy the publishers."""


VIEWS: tuple[Callable[[Node], EstimateView], ...] = (Preview, VoxelCloud, Environment, Markers)


@dataclass
class EstimateCounts:
    """Counters of keyframes and their estimates.

    Attributes:
        published: Estimates that were sent.
        failed: Keyframes without one.
        last_failure: The reason of the last of them.
        last_latency: Seconds from the arrival of the last one's image to its publication.
        last_time: When it was sent, ``time.monotonic``; NaN where none was.
    """

    published: int = 0
    failed: int = 0
    last_failure: str = ""
    last_latency: float = math.nan
    last_time: float = math.nan


class EstimateOutput:
    """Publishes estimates; the estimation worker runs one of its methods at a time.

    Attributes:
        counts: Counters for the diagnostics.
        latest: The newest estimate of this scan, None where there is none yet.
        materials: Publishes the materials.
    """

    def __init__(self, node: Node) -> None:
        """Create the publishers; late subscribers find an estimate that is unknown.

        Args:
            node: The node.
        """
        self.counts = EstimateCounts()
        self.latest: BrdfEstimate | None = None
        self._node = node
        self._failed_views: set[str] = set()
        self._views = [view(node) for view in VIEWS]
        self._publisher = node.create_publisher(BrdfEstimateMessage, "reflectance/brdf", OUTPUT_QOS)
        self.materials = MaterialOutput(node)

    @property
    def are_voxels_watched(self) -> bool:
        """Whether anyone looks at the cloud of the scan's voxels."""
        return any(view.is_watched for view in self._views if isinstance(view, VoxelCloud))

    @property
    def topic(self) -> str:
        """The full name of the estimates' topic."""
        name: str = self._publisher.topic_name
        return name

    def publish(self, keyframe: Keyframe, estimate: BrdfEstimate) -> BrdfEstimate:
        """Send an estimate.

        Args:
            keyframe: What it was made of.
            estimate: The estimate.

        Returns:
            The estimate with its latency.
        """
        estimate = dataclasses.replace(estimate, latency=time.monotonic() - keyframe.arrival)
        if self.counts.published == 0:
            self._node.get_logger().info(f"first estimate after {estimate.view_count} views")
        self._publisher.publish(estimate_to_message(estimate))
        self.latest = estimate
        self.counts.published += 1
        self.counts.last_latency = estimate.latency
        self.counts.last_time = time.monotonic()
        self._show(keyframe, estimate)
        return estimate

    def fail(self, keyframe: Keyframe, error: Exception) -> None:
        """Count a keyframe that gave no estimate, and show what there is.

        Args:
            keyframe: The keyframe.
            error: The reason.
        """
        log = self._node.get_logger()
        if isinstance(error, ReflestError):
            reason = str(error)
            if self.counts.failed == 0:
                log.warning(f"no estimate at a keyframe: {reason} (logged once)")
        else:
            reason = f"internal error, please report it: {error!r}"
            if reason != self.counts.last_failure:
                log.error("".join(traceback.format_exception(error)).rstrip())
        self.counts.failed += 1
        self.counts.last_failure = reason
        self._show(keyframe, None)

    def clear(self) -> None:
        """Empty the views, and let the topic say that nothing is known of the new scan."""
        self.latest = None
        self._publisher.publish(unknown_message())
        self.materials.clear()
        for view in self._views:
            view.clear()

    def destroy(self) -> None:
        """Destroy the publishers."""
        self.materials.destroy()
        for view in self._views:
            view.destroy()
        self._node.destroy_publisher(self._publisher)

    def _show(self, keyframe: Keyframe, estimate: BrdfEstimate | None) -> None:
        """Show a keyframe; a view that fails is logged once and holds up nothing."""
        for view in self._views:
            try:
                view.show(keyframe.snapshot, estimate)
            except Exception as error:
                name = type(view).__name__
                if name not in self._failed_views:
                    self._failed_views.add(name)
                    trace = "".join(traceback.format_exception(error)).rstrip()
                    self._node.get_logger().error(f"{name} cannot be shown: {trace}")
