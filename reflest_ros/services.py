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
from reflest_core.estimation.estimate import BrdfEstimate
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


class Session(Protocol):
    """What the services work on."""

    scanner: Scanner
    fusion: FusionWorker
    estimation: EstimationWorker

    def reset(self) -> None:
        """Forget the scan; to be run through ``fusion.call``."""


class ScanServices:
    """``~/reset``, ``~/estimate``, ``~/save`` and ``~/load``."""

    def __init__(self, node: Node, session: Session) -> None:
        self._node = node
        self._session = session
        self._fusion = session.fusion
        # A service that waits for fusion must not hold up the subscriptions.
        group = ReentrantCallbackGroup()
        self._services = [
            node.create_service(kind, f"~/{name}", answer, callback_group=group)
            for kind, name, answer in (
                (Trigger, "reset", self.reset),
                (Estimate, "estimate", self.estimate),
                (SaveScan, "save", self.save),
                (LoadScan, "load", self.load),
            )
        ]

    def destroy(self) -> None:
        """Take the services away."""
        for service in self._services:
            self._node.destroy_service(service)

    def reset(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Forget the scan."""

        def work() -> str:
            self._session.reset()
            return "the scan is empty"

        return answer_with(response, lambda: self._fusion.call(work).result())

    def estimate(self, _: Estimate.Request, response: Estimate.Response) -> Estimate.Response:
        """Estimate from all that was scanned; the answer is published as well."""

        def work() -> str:
            estimate = self._estimate_now()
            response.estimate = estimate_to_message(estimate)
            return (
                f"{estimate.model_id}, {estimate.ward_variant}, from {estimate.voxel_count} voxels"
                f" and {estimate.view_count} views"
            )

        return answer_with(response, work)

    def save(self, request: SaveScan.Request, response: SaveScan.Response) -> SaveScan.Response:
        """Write the scan to a file."""

        def work() -> str:
            self._session.scanner.save(_path(request.path))
            return f"saved {self._session.scanner.scan.voxel_count} voxels to {request.path}"

        return answer_with(response, lambda: self._fusion.call(work).result())

    def load(self, request: LoadScan.Request, response: LoadScan.Response) -> LoadScan.Response:
        """Go on from a file."""

        def work() -> str:
            self._session.scanner.load(_path(request.path))
            self._fusion.count_store()
            self._session.estimation.forget()
            return f"loaded {self._session.scanner.scan.voxel_count} voxels from {request.path}"

        return answer_with(response, lambda: self._fusion.call(work).result())

    def _estimate_now(self) -> BrdfEstimate:
        asked = time.monotonic()
        snapshot = self._fusion.call(self._fusion.snapshot).result()
        return self._session.estimation.request(Keyframe(snapshot, asked)).result()


def _path(text: str) -> Path:
    if not text:
        raise ReflestError("the request's path is empty: name a file on the node's machine")
    return Path(text).expanduser()


def answer_with(response: AnyAnswer, work: Callable[[], str]) -> AnyAnswer:
    """Fill ``response`` with what ``work`` says, or with why it failed."""
    try:
        response.message = work()
        response.success = True
    except (ReflestError, OSError) as error:
        response.message = str(error)
        response.success = False
    return response
