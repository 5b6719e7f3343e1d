# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``~/reset``, ``~/save``, ``~/load`` and ``~/set_region``: services that work on the scan."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from rclpy.node import Node
from std_srvs.srv import Trigger

from reflest_core.errors import ReflestError
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.fusion.settings import RegionSettings
from reflest_ros.parameters import set_region_parameters
from reflest_ros.services.answers import answer_with
from reflest_ros.services.file_access import FileAccess
from reflest_ros.services.node_services import NodeServices
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

    scanner: Pipeline
    fusion: FusionWorker

    def reset(self) -> None:
        """Begin a new scan; to be run through ``fusion.call_now``."""

    def load(self, path: Path) -> None:
        """Continue a saved scan.

        Args:
            path: the file.
        """


class ScanServices:
    """Reset, save, load and the region of interest."""

    def __init__(
        self, node: Node, session: Session, files: FileAccess, pools: NodeServices
    ) -> None:
        """Create the services.

        Args:
            node: Holds the parameters of the region.
            session: The scan.
            files: The files that may be used.
            pools: Answer the services.
        """
        self._node = node
        self._session = session
        self._files = files
        pools.control.create(Trigger, "~/reset", self.reset)
        pools.control.create(SetRegion, "~/set_region", self.set_region)
        pools.control.create(LoadScan, "~/load", self.load)
        pools.work.create(SaveScan, "~/save", self.save)

    def reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Begin a new scan; the old one is dropped.

        Args:
            _: empty.
            response: to fill in.
        """

        def work() -> str:
            self._session.fusion.call_now(self._session.reset).result()
            return "the scan is empty"

        return answer_with(response, work)

    def save(self, request: SaveScan.Request, response: SaveScan.Response) -> SaveScan.Response:
        """Write the scan to a file.

        Args:
            request: as it was received.
            response: to fill in.
        """

        def work() -> str:
            path = self._files.to_write(request.path)
            scanner = self._session.scanner
            self._session.fusion.call(lambda: scanner.save(path)).result()
            return f"saved {self._voxels} to {path}"

        return answer_with(response, work)

    def load(self, request: LoadScan.Request, response: LoadScan.Response) -> LoadScan.Response:
        """Continue a saved scan in its region of interest.

        Args:
            request: as it was received.
            response: to fill in.
        """

        def work() -> str:
            path = self._files.to_read(request.path)
            self._session.load(path)
            set_region_parameters(self._node, self._session.scanner.scan.region_settings)
            scan = self._session.scanner.scan
            return (
                f"loaded {self._voxels} from {path}; it continues with its own voxels of "
                f"{scan.fusion.voxel_size:g} m and region of interest {scan.region_settings.shape}"
            )

        return answer_with(response, work)

    def set_region(
        self, request: SetRegion.Request, response: SetRegion.Response
    ) -> SetRegion.Response:
        """Scan another region of interest; this begins a new scan unless it is the current one.

        Args:
            request: as it was received.
            response: to fill in.
        """

        def work() -> str:
            region = _region_of(request)
            is_new = region != self._session.scanner.scan.region_settings
            set_region_parameters(self._node, region)
            if not is_new:
                return "this is the region already: the scan continues"
            kind = "no" if region.shape == "none" else f"a {region.shape} as"
            return f"a new scan begins, with {kind} region of interest"

        return answer_with(response, work)

    @property
    def _voxels(self) -> str:
        return f"{self._session.scanner.scan.voxel_count} voxels"


def _region_of(request: SetRegion.Request) -> RegionSettings:
    if request.shape not in SHAPES:
        known = ", ".join(f"{number} ({name})" for number, name in SHAPES.items())
        raise ReflestError(f"shape = {request.shape} is none of the SHAPE_ constants: {known}")
    centre, size = request.centre, request.size
    return RegionSettings(
        SHAPES[request.shape], (centre.x, centre.y, centre.z), (size.x, size.y, size.z)
    )
