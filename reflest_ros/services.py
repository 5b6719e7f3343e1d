"""The services under the node: each runs between two frames and answers success and a message."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Protocol, TypeVar

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from std_srvs.srv import Trigger

from reflest_core.errors import ReflestError
from reflest_core.estimation.scanner import Scanner
from reflest_ros.estimate_message import estimate_to_message
from reflest_ros.estimation_worker import EstimationWorker
from reflest_ros.fusion_worker import FusionWorker, Keyframe
from reflest_ros.srv import Estimate, LoadScan, SaveScan


class Answer(Protocol):
    """What every response holds."""

    success: bool
    message: str


AnyAnswer = TypeVar("AnyAnswer", bound=Answer)


class ScanServices:
    """``~/reset``, ``~/estimate``, ``~/save`` and ``~/load``."""

    def __init__(
        self, node: Node, fusion: FusionWorker, estimation: EstimationWorker, scanner: Scanner
    ) -> None:
        self._fusion = fusion
        self._estimation = estimation
        self._scanner = scanner
        # A service that waits for fusion must not hold up the subscriptions.
        group = ReentrantCallbackGroup()
        node.create_service(Trigger, "~/reset", self.reset, callback_group=group)
        node.create_service(Estimate, "~/estimate", self.estimate, callback_group=group)
        node.create_service(SaveScan, "~/save", self.save, callback_group=group)
        node.create_service(LoadScan, "~/load", self.load, callback_group=group)

    def reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Forget the scan."""

        def work() -> str:
            self._fusion.reset()
            self._estimation.forget()
            return "the scan is empty"

        return _answer(response, lambda: self._fusion.call(work).result())

    def estimate(self, _: Estimate.Request, response: Estimate.Response) -> Estimate.Response:
        """Estimate from all that was scanned; the answer is published as well."""
        asked = time.monotonic()

        def work() -> str:
            snapshot = self._fusion.call(self._fusion.snapshot).result()
            estimate = self._estimation.request(Keyframe(snapshot, asked)).result()
            response.estimate = estimate_to_message(estimate)
            return (
                f"{estimate.model_id}, {estimate.ward_variant}, from {estimate.voxel_count} voxels"
                f" and {estimate.view_count} views"
            )

        return _answer(response, work)

    def save(self, request: SaveScan.Request, response: SaveScan.Response) -> SaveScan.Response:
        """Write the scan to a file."""

        def work() -> str:
            self._scanner.save(_path(request.path))
            return f"saved {self._scanner.scan.voxel_count} voxels to {request.path}"

        return _answer(response, lambda: self._fusion.call(work).result())

    def load(self, request: LoadScan.Request, response: LoadScan.Response) -> LoadScan.Response:
        """Go on from a file."""

        def work() -> str:
            self._scanner.load(_path(request.path))
            self._fusion.count_store()
            self._estimation.forget()
            return f"loaded {self._scanner.scan.voxel_count} voxels from {request.path}"

        return _answer(response, lambda: self._fusion.call(work).result())


def _path(text: str) -> Path:
    if not text:
        raise ReflestError("the request's path is empty: name a file on the node's machine")
    return Path(text).expanduser()


def _answer(response: AnyAnswer, work: Callable[[], str]) -> AnyAnswer:
    try:
        response.message = work()
        response.success = True
    except (ReflestError, OSError) as error:
        response.message = str(error)
        response.success = False
    return response
