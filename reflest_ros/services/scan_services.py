# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``~/reset``, ``~/save``, ``~/load`` and ``~/set_region``: what becomes of the scan."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from rclpy.node import Node
from std_srvs.srv import Trigger

from reflest_core.errors import ReflestError
from reflest_core.estimation.scanner import Scanner
from reflest_core.fusion.settings import RegionSettings
from reflest_ros.region_parameters import set_region_parameters
from reflest_ros.services.service_answer import answer_with, given_path
from reflest_ros.services.waiting_services import WaitingServices
from reflest_ros.srv import LoadScan, SaveScan, SetRegion
from reflest_ros.workers.fusion_worker import FusionWorker

SHAPES = {
    SetRegion.Request.SHAPE_NONE: "none",
    SetRegion.Request.SHAPE_BOX: "box",
    SetRegion.Request.SHAPE_SPHERE: "sphere",
}
"""Values of the parameter region.shape."""


class Session(Protocol):
    """What the services work on."""

    scanner: Scanner
    fusion: FusionWorker

    def reset(self) -> None:
        """Forget the scan; to be run through ``fusion.call``."""

    def load(self, path: Path) -> None:
        """Go on from a file; to be run through ``fusion.call``."""


class ScanServices:
    """Each runs in the fusion thread, between two frames."""

    def __init__(self, node: Node, session: Session, waiting: WaitingServices) -> None:
        self._node = node
        self._session = session
        waiting.create(Trigger, "~/reset", self.reset)
        waiting.create(SaveScan, "~/save", self.save)
        # Those that set parameters take turns with the node's own parameter services.
        self._services = [
            node.create_service(LoadScan, "~/load", self.load),
            node.create_service(SetRegion, "~/set_region", self.set_region),
        ]

    def destroy(self) -> None:
        """Take the node's services away."""
        for service in self._services:
            self._node.destroy_service(service)

    def reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Forget the scan."""

        def work() -> str:
            self._between_frames(self._session.reset)
            return "the scan is empty"

        return answer_with(response, work)

    def save(self, request: SaveScan.Request, response: SaveScan.Response) -> SaveScan.Response:
        """Write the scan to a file."""

        def work() -> str:
            path = given_path(request.path)
            self._between_frames(lambda: self._session.scanner.save(path))
            return f"saved {self._voxels} to {path}"

        return answer_with(response, work)

    def load(self, request: LoadScan.Request, response: LoadScan.Response) -> LoadScan.Response:
        """Go on from a file, in its region of interest."""

        def work() -> str:
            path = given_path(request.path)
            self._between_frames(lambda: self._session.load(path))
            set_region_parameters(self._node, self._session.scanner.scan.region_settings)
            scan = self._session.scanner.scan
            return (
                f"loaded {self._voxels} from {path}; it goes on with its own settings: voxels of "
                f"{scan.fusion.voxel_size:g} m, {scan.fusion.memory_budget_mb:g} MB, region of "
                f"interest {scan.region_settings.shape}"
            )

        return answer_with(response, work)

    def set_region(
        self, request: SetRegion.Request, response: SetRegion.Response
    ) -> SetRegion.Response:
        """Scan another region of interest; another one than now begins a new scan."""

        def work() -> str:
            region = _region_of(request)
            is_new = region != self._session.scanner.scan.region_settings
            set_region_parameters(self._node, region)
            if not is_new:
                return "this is the region already: the scan goes on"
            kind = "no" if region.shape == "none" else f"a {region.shape} as"
            return f"a new scan begins, with {kind} region of interest"

        return answer_with(response, work)

    @property
    def _voxels(self) -> str:
        return f"{self._session.scanner.scan.voxel_count} voxels"

    def _between_frames(self, work: Callable[[], None]) -> None:
        self._session.fusion.call(work).result()


def _region_of(request: SetRegion.Request) -> RegionSettings:
    if request.shape not in SHAPES:
        known = ", ".join(f"{number} ({name})" for number, name in SHAPES.items())
        raise ReflestError(f"shape = {request.shape} is none of the SHAPE_ constants: {known}")
    centre, size = request.centre, request.size
    return RegionSettings(
        SHAPES[request.shape], (centre.x, centre.y, centre.z), (size.x, size.y, size.z)
    )
