# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The thread that owns the scan: messages in, keyframes out, and services between two frames."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, TypeVar

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.frame import Frame
from reflest_core.capture.messages import Role, SensorMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.errors import ReflestError
from reflest_core.estimation.scanner import KeyframeSnapshot, Scanner
from reflest_ros.workers.fusion_counts import FusionCounts
from reflest_ros.workers.worker_thread import worker_thread

MOST_ARRIVALS = 1000
"""Images whose time of arrival is remembered while they wait to be matched."""

T = TypeVar("T")


@dataclass(frozen=True)
class Keyframe:
    """A snapshot to estimate from; ``arrival`` is when its image came, ``time.monotonic``."""

    snapshot: KeyframeSnapshot
    arrival: float


@dataclass(frozen=True)
class _Arrived:
    role: Role
    message: SensorMessage
    at: float


@dataclass(frozen=True)
class _Job:
    work: Callable[[], Any]
    future: Future[Any]

    def run(self) -> None:
        try:
            self.future.set_result(self.work())
        except Exception as error:  # raised again by the future's result(), where it is handled
            self.future.set_exception(error)


class FusionWorker:
    """Takes messages from the callbacks and drives the assembler and the scanner, alone.

    ``settle_after``: seconds without a message after which waiting frames are settled.
    """

    def __init__(
        self,
        assembler: FrameAssembler,
        scanner: Scanner,
        on_keyframe: Callable[[Keyframe], None],
        on_crash: Callable[[BaseException], None],
        queue_size: int,
        settle_after: float,
    ) -> None:
        self.counts = FusionCounts()
        self._assembler = assembler
        self._scanner = scanner
        self._on_keyframe = on_keyframe
        self._queue_size = queue_size
        self._settle_after = settle_after
        self._queue: queue.SimpleQueue[_Arrived | _Job | None] = queue.SimpleQueue()
        self._arrivals: dict[int, float] = {}
        self._reported_drops = 0
        self._is_stopping = False
        self._stop_lock = threading.Lock()
        self._thread = worker_thread("fusion", self._run, on_crash)

    @property
    def waiting(self) -> int:
        """Messages and jobs in the queue."""
        return self._queue.qsize()

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread after the frame in hand; what waits is dropped."""
        with self._stop_lock:
            self._is_stopping = True
        self._queue.put(None)
        self._thread.join()
        while not self._queue.empty():
            item = self._queue.get()
            if isinstance(item, _Job):
                item.future.set_exception(_shutting_down())

    def offer(self, role: Role, message: SensorMessage) -> None:
        """Queue a message, or count it as dropped where the queue is full."""
        self.counts.messages[role] += 1
        if self._queue.qsize() >= self._queue_size:
            self.counts.dropped += 1
        else:
            self._queue.put(_Arrived(role, message, time.monotonic()))

    def refuse(self, refusal: FrameRefused) -> None:
        """Count what could not even become a message, in its turn."""
        self.call(lambda: self._assembler.refuse(refusal))

    def call(self, work: Callable[[], T]) -> Future[T]:
        """Run ``work`` in this thread after all that was queued before it."""
        future: Future[T] = Future()
        with self._stop_lock:
            if self._is_stopping:
                future.set_exception(_shutting_down())
            else:
                self._queue.put(_Job(work, future))
        return future

    def snapshot(self) -> KeyframeSnapshot:
        """Settle what waits and copy the scan; to be run through :meth:`call`."""
        self.settle()
        return self._scanner.snapshot()

    def settle(self) -> None:
        """Fuse what still waits for later messages; to be run through :meth:`call`."""
        self._fuse(self._assembler.flush())

    def reset(self) -> None:
        """Forget the scan and the waiting messages; to be run through :meth:`call`."""
        self.forget_messages()
        self._scanner.reset()
        self.count_store()

    def forget_messages(self) -> None:
        """Forget the waiting messages and how far time had come; to be run through :meth:`call`."""
        self._assembler.reset()
        self._arrivals.clear()

    def count_store(self) -> None:
        """Bring the store's counts up to date; to be run through :meth:`call`."""
        self.counts.take_store(self._scanner.scan)

    def _run(self) -> None:
        while not self._is_stopping:
            try:
                item = self._queue.get(timeout=self._settle_after)
            except queue.Empty:
                self.settle()
                item = self._queue.get()
            if isinstance(item, _Job):
                item.run()
            elif item is not None and not self._is_stopping:
                self._take(item)

    def _take(self, arrived: _Arrived) -> None:
        if arrived.role is Role.RGB:
            self._arrivals[arrived.message.stamp_ns] = arrived.at
            if len(self._arrivals) > MOST_ARRIVALS:
                del self._arrivals[next(iter(self._arrivals))]
        self._report_drops()
        self._fuse(self._assembler.add(arrived.role, arrived.message))

    def _fuse(self, frames: list[Frame]) -> None:
        for frame in frames:
            self.counts.matched += 1
            arrival = self._arrivals.pop(frame.stamp_ns, time.monotonic())
            self._arrivals = {k: v for k, v in self._arrivals.items() if k > frame.stamp_ns}
            try:
                scanned = self._scanner.fuse(frame)
            except FrameRefused as refusal:
                self._assembler.refuse(refusal)
                continue
            self.counts.fused += 1
            self.counts.redundant += scanned.fused.is_redundant
            self.counts.light_alone += scanned.fused.is_light_alone
            if scanned.keyframe is not None:
                self.counts.keyframes += 1
                self._on_keyframe(Keyframe(scanned.keyframe, arrival))  # first: it is waited for
                self.counts.take_light(self._scanner.scan)
            self.count_store()

    def _report_drops(self) -> None:
        while self._reported_drops < self.counts.dropped:
            self._reported_drops += 1
            self._assembler.refuse(
                FrameRefused(
                    RefusalCause.QUEUE_FULL,
                    f"fusion is slower than the input: {self._queue_size} messages waited and a "
                    "further one was dropped; raise fusion.voxel_size, lower the camera's rate or "
                    "raise input.queue_size",
                )
            )


def _shutting_down() -> ReflestError:
    return ReflestError("the estimator is shutting down")
