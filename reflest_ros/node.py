"""The estimator node: topics in, estimates out; all work is done by the core in two threads."""

from __future__ import annotations

import dataclasses
import threading
import time
import traceback

from rclpy.node import Node

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.refusal import FrameRefused
from reflest_core.errors import ReflestError
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.scanner import Scanner
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.estimation.warm_up import warm_up
from reflest_core.fusion.keyframe import KeyframePolicy
from reflest_ros.diagnostics import Diagnostics, EstimateCounts
from reflest_ros.estimate_message import estimate_to_message
from reflest_ros.estimation_worker import EstimationWorker
from reflest_ros.fusion_worker import FusionWorker
from reflest_ros.msg import BrdfEstimate as BrdfEstimateMessage
from reflest_ros.node_name import NODE_NAME
from reflest_ros.parameters import declare_parameters, guard_parameters
from reflest_ros.qos import OUTPUT_QOS
from reflest_ros.services import ScanServices
from reflest_ros.silence import SilenceWatch
from reflest_ros.subscriptions import input_topics, subscribe


class EstimatorNode(Node):
    """Subscribes, fuses, estimates at keyframes and publishes.

    Raises :class:`ReflestError` where a parameter or the weights cannot be used.
    """

    def __init__(self) -> None:
        super().__init__(NODE_NAME)
        self.has_crashed = threading.Event()
        self._estimates = EstimateCounts()
        node_settings, self._settings = declare_parameters(self)
        topics = input_topics(self, node_settings, self._settings.capture.use_mask)
        self._publisher = self.create_publisher(BrdfEstimateMessage, "reflectance/brdf", OUTPUT_QOS)

        self.get_logger().info("starting (the first start after installation compiles for 30 s)")
        self._scanner = Scanner(self._settings)
        warm_up(self._scanner.estimator)
        assembler = FrameAssembler(self._settings.capture, topics, self._on_refusal)
        self._estimation = EstimationWorker(
            self._scanner.estimate, self._publish, self._on_failure, self.crash
        )
        self._fusion = FusionWorker(
            assembler, self._scanner, self._estimation.offer, self.crash,
            node_settings.input.queue_size, node_settings.input.settle,
        )  # fmt: skip
        ScanServices(self, self._fusion, self._estimation, self._scanner)
        guard_parameters(self, self._apply)
        self._estimation.start()
        self._fusion.start()

        inputs = subscribe(self, topics, node_settings.input.reliability, self._fusion.offer)
        diagnostics = Diagnostics(
            self, self._fusion, self._estimation, assembler.refusals, self._estimates,
            SilenceWatch(self, inputs, node_settings.input.silence),
            self._settings.fusion.memory_budget_mb,
        )  # fmt: skip
        self.create_timer(node_settings.input.diagnostics_period, diagnostics.publish)
        names = ", ".join(topics.values())
        self.get_logger().info(
            f"listening to {names}; publishing {self._publisher.topic_name} "
            f"({self._scanner.estimator.predictor.model_id})"
        )

    def crash(self, error: BaseException) -> None:
        """Report what should not happen in one of the threads; the process then ends."""
        trace = "".join(traceback.format_exception(error))
        self.get_logger().fatal(f"stopping, for this should not happen: {trace}")
        self.has_crashed.set()

    def destroy_node(self) -> None:
        """End the threads, then the node."""
        self._fusion.stop()
        self._estimation.stop()
        super().destroy_node()

    def _on_refusal(self, refusal: FrameRefused, is_first: bool) -> None:
        if is_first:
            self.get_logger().warning(f"{refusal} (cause: {refusal.cause.value}; said once)")

    def _publish(self, estimate: BrdfEstimate, arrival: float) -> BrdfEstimate:
        estimate = dataclasses.replace(estimate, latency=time.monotonic() - arrival)
        if self._estimates.published == 0:
            self.get_logger().info(f"first estimate after {estimate.view_count} views")
        self._publisher.publish(estimate_to_message(estimate))
        self._estimates.published_one(estimate)
        return estimate

    def _on_failure(self, error: ReflestError) -> None:
        if self._estimates.failed == 0:
            self.get_logger().warning(f"no estimate at a keyframe: {error} (said once)")
        self._estimates.failed += 1
        self._estimates.last_failure = str(error)

    def _apply(self, settings: ReflestSettings) -> None:
        """Take changed live parameters; the structural ones are read-only."""
        if settings.estimation != self._settings.estimation:
            self._scanner.estimator = Estimator(settings.estimation)
        if settings.keyframe != self._settings.keyframe:
            self._fusion.call(
                lambda: setattr(self._scanner, "keyframes", KeyframePolicy(settings.keyframe))
            )
        self._settings = settings
