# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Everything that lives from configure to cleanup: the scan, its threads, services and topics."""

from __future__ import annotations

import contextlib
import gc
import time
from collections.abc import Callable
from pathlib import Path

from rclpy.node import Node

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.estimation.warm_up import warm_up
from reflest_core.fusion.keyframe import KeyframePolicy
from reflest_core.fusion.settings import RegionSettings
from reflest_ros.inputs.silence import ClockWatch
from reflest_ros.inputs.subscriptions import Inputs
from reflest_ros.outputs.estimate_output import EstimateOutput
from reflest_ros.outputs.material_output import MaterialRequest
from reflest_ros.parameters import set_region_parameters
from reflest_ros.services.estimate_services import EstimateServices
from reflest_ros.services.file_access import FileAccess
from reflest_ros.services.material_services import MaterialServices
from reflest_ros.services.node_services import NodeServices
from reflest_ros.services.scan_services import ScanServices
from reflest_ros.settings import NodeSettings
from reflest_ros.workers.autosave import Autosave
from reflest_ros.workers.estimation_worker import EstimationWorker
from reflest_ros.workers.fusion_worker import FusionWorker, Keyframe

MATERIAL_VOXELS = 50_000
"""Voxels of which materials are estimated; a larger scan is thinned evenly."""


class ScanSession:
    """Fuses what the inputs bring while it is active, and answers services until it is closed.

    Attributes:
        node_settings: The node's parameters that hold until cleanup.
        inputs: The topics that are listened to.
        scanner: The scan; it belongs to the fusion thread.
        autosave: Saves the scan regularly.
        assembler: Makes frames of messages and counts refusals.
        output: Publishes estimates.
        estimation: The thread that estimates.
        fusion: The thread that fuses.
        is_active: Whether messages are listened to.
    """

    def __init__(
        self,
        node: Node,
        node_settings: NodeSettings,
        settings: ReflestSettings,
        pools: NodeServices,
        on_crash: Callable[[BaseException], None],
    ) -> None:
        """Load, compile, allocate, start the threads and offer the services.

        Args:
            node: The node.
            node_settings: The node's own parameters.
            settings: The core's parameters.
            pools: Answer its services.
            on_crash: Called with what ended a thread.

        Raises:
            ReflestError: The settings, the weights or the autosave's file cannot be used.
        """
        self._node = node
        self._settings = settings
        self.node_settings = node_settings
        self._log = node.get_logger()
        self.is_active = False
        files = FileAccess(node_settings.files, node.get_name())
        self.inputs = Inputs(node, node_settings, settings.capture)
        with contextlib.ExitStack() as on_failure:
            self.scanner = Pipeline(settings)
            warm_up(self.scanner.estimator, settings.region.shape == "none")
            self.autosave = Autosave(node, node_settings.autosave, self.scanner)
            on_failure.callback(self.autosave.unlock)
            self.assembler = FrameAssembler(
                settings.capture,
                self.inputs.topics,
                self._on_refusal,
                self._on_clock_jump,
                self._log.warning,
            )
            self.output = EstimateOutput(node)
            on_failure.callback(self.output.destroy)
            self.scanner.is_all_shown = lambda: self.output.are_voxels_watched
            self.estimation = EstimationWorker(
                self.scanner.estimate, self.output, on_crash, self._materials
            )
            self.fusion = FusionWorker(
                self.assembler,
                self.scanner,
                self.estimation.offer,
                on_crash,
                node_settings.input.queue_size,
                node_settings.input.settle,
            )
            if self.autosave.resume():
                self._continue_loaded_scan()
            on_failure.pop_all()
        ScanServices(node, self, files, pools)
        MaterialServices(pools.quick, self.output.materials)
        threads = self.fusion, self.estimation
        EstimateServices(pools, files, self.scanner, *threads, self.output)
        self._clock_watch = ClockWatch(node, settings.capture.clock_jump, self._ros_clock_jumped)
        self.estimation.start()
        self.fusion.start()
        self.autosave.start(self.fusion)

    def activate(self) -> None:
        """Subscribe."""
        self.inputs.activate(self.fusion)
        self.is_active = True

    def deactivate(self) -> None:
        """Unsubscribe; the scan stays, and messages that wait are still fused."""
        self.is_active = False
        self.inputs.deactivate()

    def close(self) -> None:
        """End the threads and free everything."""
        self.is_active = False
        self.inputs.deactivate()
        self._clock_watch.stop()
        self.fusion.stop()
        self.autosave.stop()
        self.estimation.stop()
        self.output.destroy()

    def reset(self) -> None:
        """Begin a new scan; to be run through ``fusion.call_now``."""
        self.fusion.reset()
        self.estimation.forget()

    def load(self, path: Path) -> None:
        """Continue a saved scan.

        Args:
            path: A scan file; it is read in the calling thread, while frames are fused.

        Raises:
            ReflestError: The file cannot be used; the scan is as it was.
        """
        scan = self.scanner.read(path)

        def work() -> None:
            self.fusion.forget_messages()
            self.scanner.continue_scan(scan)
            self.estimation.forget()
            self._offer_loaded_scan()

        self.fusion.call_now(work).result()

    def prepare(self, settings: ReflestSettings) -> Callable[[], None]:
        """Load what changed live parameters need; nothing changes yet.

        Args:
            settings: The parameters as they shall be.

        Returns:
            What puts them to use. Another region begins a new scan.

        Raises:
            ReflestError: They cannot be used.
        """
        use_estimation: Callable[[], None] | None = None
        if settings.estimation != self._settings.estimation:
            use_estimation = self.scanner.prepare_estimation(settings.estimation)

        def put_to_use() -> None:
            if use_estimation is not None:
                use_estimation()
                gc.collect()  # reference cycles hold the old network's arrays
            if settings.keyframe != self._settings.keyframe:
                policy = KeyframePolicy(settings.keyframe)
                self.fusion.call_now(lambda: setattr(self.scanner, "keyframes", policy)).result()
            if settings.region != self.scanner.scan.region_settings:
                self.fusion.call_now(lambda: self._set_region(settings.region)).result()
            self._settings = settings

        return put_to_use

    def _materials(self) -> Callable[[], None] | None:
        """Estimate all materials of the scan as it is now; return what publishes them."""
        output = self.output.materials
        if not output.is_wanted:
            return None
        try:
            request = self.fusion.call_now(self._material_request).result()
            found = self.scanner.materials(request.snapshot)
        except Exception as error:
            output.fail(error)
            return None

        def publish() -> None:
            try:
                output.publish(request, found)
            except Exception as error:  # of one of the views: the node goes on
                output.fail(error)

        return publish

    def _material_request(self) -> MaterialRequest:
        """Copy what materials are made of; in the fusion thread."""
        return MaterialRequest(
            self.scanner.snapshot(MATERIAL_VOXELS),
            self.fusion.last_frame,
            self.scanner.scan.fusion.voxel_size,
            time.monotonic(),
        )

    def _set_region(self, region: RegionSettings) -> None:
        self.fusion.forget_messages()
        self.scanner.set_region(region)
        self._scan_changed()

    def _scan_changed(self) -> None:
        self.fusion.count_store()
        self.estimation.forget()

    def _continue_loaded_scan(self) -> None:
        set_region_parameters(self._node, self.scanner.scan.region_settings)
        self._offer_loaded_scan()

    def _offer_loaded_scan(self) -> None:
        """Publish what a loaded scan holds, or the topic would stay empty until a keyframe."""
        self.fusion.count_store()
        if self.scanner.scan.voxel_count:
            self.estimation.offer(Keyframe(self.scanner.snapshot(), time.monotonic()))

    def _on_clock_jump(self, _: str) -> None:
        """Stamps went back: begin a new scan or go on with this one, as the user chose."""
        if self.node_settings.input.reset_on_clock_jump:
            self.scanner.reset()
            self._scan_changed()
        else:
            self.scanner.restart_clock()

    def _ros_clock_jumped(self, sentence: str) -> None:
        """The node's clock went back: messages that wait belong to the time before."""

        def work() -> None:
            self.assembler.refuse(FrameRefused(RefusalCause.CLOCK_JUMP, sentence))
            self.fusion.forget_messages()
            self._on_clock_jump(sentence)

        self.fusion.call_now(work)

    def _on_refusal(self, refusal: FrameRefused, is_first: bool) -> None:
        if is_first:
            self._log.warning(f"{refusal} (cause: {refusal.cause.value}; logged once)")
