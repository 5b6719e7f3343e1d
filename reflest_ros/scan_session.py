# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""All that lives from configure to cleanup: the scan, its two threads, services and topics."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rclpy.node import Node

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.scanner import Scanner
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.estimation.warm_up import warm_up
from reflest_core.fusion.keyframe import KeyframePolicy
from reflest_core.fusion.settings import RegionSettings
from reflest_ros.inputs.clock_watch import ClockWatch
from reflest_ros.inputs.subscriptions import Inputs
from reflest_ros.outputs.estimate_output import EstimateOutput
from reflest_ros.outputs.views import VIEWS
from reflest_ros.region_parameters import set_region_parameters
from reflest_ros.services.estimate_services import EstimateServices
from reflest_ros.services.scan_services import ScanServices
from reflest_ros.services.waiting_services import WaitingServices
from reflest_ros.settings import NodeSettings
from reflest_ros.workers.autosave import Autosave
from reflest_ros.workers.estimation_worker import EstimationWorker
from reflest_ros.workers.fusion_worker import FusionWorker


class ScanSession:
    """Fuses what the inputs bring while it is active, and answers services until it is closed.

    Raises :class:`ReflestError` where the settings or the weights cannot be used.
    """

    def __init__(
        self,
        node: Node,
        node_settings: NodeSettings,
        settings: ReflestSettings,
        on_crash: Callable[[BaseException], None],
    ) -> None:
        self._settings = settings
        self._resets_on_jump = node_settings.input.reset_on_clock_jump
        self._log = node.get_logger()
        self.inputs = Inputs(node, node_settings, settings.capture)
        self.scanner = Scanner(settings)
        warm_up(self.scanner.estimator)
        self.autosave = Autosave(node, node_settings.autosave, self.scanner)
        self.assembler = FrameAssembler(
            settings.capture,
            self.inputs.topics,
            self._on_refusal,
            self._on_clock_jump,
            self._log.warning,
        )
        self.is_active = False
        self.output = EstimateOutput(node, [view(node) for view in VIEWS])
        self.estimation = EstimationWorker(self.scanner.estimate, self.output, on_crash)
        self.fusion = FusionWorker(
            self.assembler,
            self.scanner,
            self.estimation.offer,
            on_crash,
            node_settings.input.queue_size,
            node_settings.input.settle,
        )
        self.waiting_services = WaitingServices(node, on_crash)
        self._services = ScanServices(node, self, self.waiting_services)
        EstimateServices(self.waiting_services, self.fusion, self.estimation)
        if self.autosave.resume():
            set_region_parameters(node, self.scanner.scan.region_settings)
            self.fusion.count_store()
        self._clock_watch = ClockWatch(node, settings.capture.clock_jump, self._ros_clock_jumped)
        self.estimation.start()
        self.fusion.start()
        self.autosave.start(self.fusion)
        self.waiting_services.start()

    def activate(self) -> None:
        """Subscribe."""
        self.inputs.activate(self.fusion)
        self.is_active = True

    def deactivate(self) -> None:
        """Unsubscribe, and fuse what had come; the scan stays."""
        self.is_active = False
        self.inputs.deactivate()
        self.fusion.call(self.fusion.settle).result()

    def close(self) -> None:
        """End the threads and give everything back."""
        self.inputs.deactivate()
        self._clock_watch.stop()
        self._services.destroy()
        self.waiting_services.close()
        self.fusion.stop()
        self.autosave.stop()
        self.estimation.stop()
        self.output.destroy()

    def reset(self) -> None:
        """Forget the scan; to be run through ``fusion.call``."""
        self.fusion.reset()
        self.estimation.forget()

    def load(self, path: Path) -> None:
        """Go on from a saved scan; to be run through ``fusion.call``."""
        self.scanner.load(path)
        self._scan_changed()

    def apply(self, settings: ReflestSettings) -> None:
        """Take changed live parameters, or refuse them with a :class:`ReflestError`.

        Another region begins a new scan.
        """
        if settings.region != self.scanner.scan.region_settings:
            self.fusion.call(lambda: self._set_region(settings.region)).result()
        if settings.estimation != self._settings.estimation:
            self.scanner.estimator = Estimator(settings.estimation)
        if settings.keyframe != self._settings.keyframe:
            self.fusion.call(
                lambda: setattr(self.scanner, "keyframes", KeyframePolicy(settings.keyframe))
            )
        self._settings = settings

    def _set_region(self, region: RegionSettings) -> None:
        self.scanner.set_region(region)
        self._scan_changed()

    def _scan_changed(self) -> None:
        self.fusion.count_store()
        self.estimation.forget()

    def _on_clock_jump(self, _: str) -> None:
        """Stamps went back: empty the scan or go on with it, as the user chose."""
        if self._resets_on_jump:
            self.scanner.reset()
            self._scan_changed()
        else:
            self.scanner.restart_clock()

    def _ros_clock_jumped(self, sentence: str) -> None:
        """The node's clock went back: what waits belongs to the time before."""

        def work() -> None:
            self.assembler.refuse(FrameRefused(RefusalCause.CLOCK_JUMP, sentence))
            self.fusion.forget_messages()
            self._on_clock_jump(sentence)

        self.fusion.call(work)

    def _on_refusal(self, refusal: FrameRefused, is_first: bool) -> None:
        if is_first:
            self._log.warning(f"{refusal} (cause: {refusal.cause.value}; said once)")
