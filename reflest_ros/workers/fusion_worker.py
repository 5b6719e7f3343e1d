# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The thread that owns the scan: messages in, keyframes out, and requests between two frames."""

from __future__ import annotations

import math
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, TypeVar

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.frame import Frame
from reflest_core.capture.messages import Role, SensorMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.estimation.pipeline import KeyframeSnapshot, Pipeline
from reflest_ros.threads import resolve, shutting_down, worker_thread
from reflest_ros.workers.fusion_counts import FusionCounts

MOST_ARRIVALS = 1000
"""Images whose time of arrival is remembered while they wait to be matched."""

PATIENCE = 0.5
"""Seconds that a request waits for earlier messages while further ones keep coming."""

RECENT = 0.3
"""Seconds since the last message within which messages count as coming."""

T = TypeVar("T")


@dataclass(frozen=True)
class Keyframe:
    """A snapshot to estimate from.

    Attributes:
        snapshot: A copy of the scan.
        arrival: When its image or the request arrived, ``time.monotonic``.
    """

    snapshot: KeyframeSnapshot
    arrival: float


@dataclass(frozen=True)
class _Arrived:
    role: Role
    message: SensorMessage
    at: float


@dataclass(frozen=True)
class _Job:
    """Work between two frames.

    ``after``: messages that were queued when it was asked for, to be fused before it. ``at``:
    ``time.monotonic`` of the request.
    """

    work: Callable[[], Any]
    future: Future[Any]
    after: int
    at: float


class FusionWorker:
    """Takes messages from the callbacks and drives the assembler and the scanner, alone.

    A request waits for the messages that came before it, so that a scan is whole when it is asked
    for; while messages keep coming it waits :data:`PATIENCE` at most, so that a node that is slower
    than its input still answers.

    Attributes:
        counts: Counters for the diagnostics.
        last_frame: The last frame that was fused, None in a new scan.
    """

    def __init__(
        self,
        assembler: FrameAssembler,
        scanner: Pipeline,
        on_keyframe: Callable[[Keyframe], None],
        on_crash: Callable[[BaseException], None],
        queue_size: int,
        settle_after: float,
    ) -> None:
        """Prepare the thread.

        Args:
            assembler: Makes frames of messages.
            scanner: Fuses frames.
            on_keyframe: Called in the thread with each keyframe.
            on_crash: Called with what ended the thread.
            queue_size: Messages that may wait.
            settle_after: Seconds without a message after which waiting frames are used as they are.
        """
        self.counts = FusionCounts()
        self.last_frame: Frame | None = None
        self._assembler = assembler
        self._scanner = scanner
        self._on_keyframe = on_keyframe
        self._queue_size = queue_size
        self._settle_after = settle_after
        self._messages: deque[_Arrived] = deque()
        self._jobs: deque[_Job] = deque()
        self._changed = threading.Condition()
        self._queued = 0
        self._taken = 0
        self._arrivals: dict[int, float] = {}
        self._unreported_drops = 0
        self._last_offer = -math.inf
        self._is_stopping = False
        self._thread = worker_thread("fusion", self._run, on_crash)

    @property
    def waiting(self) -> int:
        """Messages and requests that wait."""
        return len(self._messages) + len(self._jobs)

    @property
    def is_receiving(self) -> bool:
        """Whether messages keep coming."""
        return time.monotonic() - self._last_offer < RECENT

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread after the current frame; what waits is dropped, its futures fail."""
        with self._changed:
            self._is_stopping = True
            self._changed.notify()
        if self._thread.ident is not None:
            self._thread.join()
        self._messages.clear()
        while self._jobs:
            self._jobs.popleft().future.set_exception(shutting_down())

    def offer(self, role: Role, message: SensorMessage) -> None:
        """Queue a message, or count it as dropped where the queue is full.

        Args:
            role: What the message is to the scan.
            message: Its image bytes are not copied.
        """
        self.counts.messages[role] += 1
        self._last_offer = time.monotonic()
        with self._changed:
            if len(self._messages) >= self._queue_size:
                self.counts.dropped += 1
                self._unreported_drops += 1
            else:
                self._queued += 1
                self._messages.append(_Arrived(role, message, time.monotonic()))
                self._changed.notify()

    def refuse(self, refusal: FrameRefused) -> None:
        """Count what could not even become a message.

        Args:
            refusal: With the cause and the number of messages.
        """
        self.call_now(lambda: self._assembler.refuse(refusal))

    def call(self, work: Callable[[], T]) -> Future[T]:
        """Run ``work`` in this thread after the messages that were queued before it.

        Args:
            work: Its result or exception becomes the future's.

        Returns:
            A future that always ends, with :class:`ReflestError` where the node shuts down.
        """
        return self._add(work, self._queued)

    def call_now(self, work: Callable[[], T]) -> Future[T]:
        """Run ``work`` in this thread after the current frame, as :meth:`call`.

        Args:
            work: Its result or exception becomes the future's.

        Returns:
            A future that always ends.
        """
        return self._add(work, 0)

    def snapshot(self) -> KeyframeSnapshot:
        """Use what waits for its partners and copy the scan; to be run through :meth:`call`.

        Returns:
            The copy.
        """
        self.settle()
        return self._scanner.snapshot()

    def settle(self) -> None:
        """Fuse what still waits for later messages; to be run through :meth:`call`."""
        try:
            frames = self._assembler.flush()
        except Exception as error:
            self._refuse_after(error, "a waiting frame")
        else:
            self._fuse(frames)

    def reset(self) -> None:
        """Drop the scan and the waiting messages; to be run through :meth:`call_now`."""
        self.forget_messages()
        self._scanner.reset()
        self.count_store()

    def forget_messages(self) -> None:
        """Drop the waiting messages and the latest time; to be run through :meth:`call_now`."""
        with self._changed:
            self._taken += len(self._messages)
            self.counts.discarded += len(self._messages)
            self._messages.clear()
        self._assembler.reset()
        self._arrivals.clear()
        self.last_frame = None

    def count_store(self) -> None:
        """Bring the store's counts up to date; to be run in this thread."""
        self.counts.take_store(self._scanner.scan)

    def _add(self, work: Callable[[], T], after: int) -> Future[T]:
        future: Future[T] = Future()
        with self._changed:
            if self._is_stopping:
                future.set_exception(shutting_down())
            else:
                self._jobs.append(_Job(work, future, after, time.monotonic()))
                self._changed.notify()
        return future

    def _run(self) -> None:
        is_settled = False
        while not self._is_stopping:
            item = self._next(None if is_settled else self._settle_after)
            is_settled = item is None
            if item is None:
                self.settle()
            elif isinstance(item, _Job):
                resolve([item.future], item.work)
            else:
                self._take(item)

    def _next(self, timeout: float | None) -> _Job | _Arrived | None:
        """Wait for the next thing to do; None after ``timeout`` seconds without one."""
        with self._changed:
            while not self._is_stopping:
                if (job := self._due_job()) is not None:
                    self._jobs.remove(job)
                    return job
                if self._messages:
                    self._taken += 1
                    return self._messages.popleft()
                if not self._changed.wait(timeout):
                    break
        return None

    def _due_job(self) -> _Job | None:
        now = time.monotonic()
        for job in self._jobs:
            is_late = now - job.at >= PATIENCE and self._queued > job.after
            if job.after <= self._taken or is_late:
                return job
        return None

    def _take(self, arrived: _Arrived) -> None:
        if arrived.role is Role.RGB:
            self._arrivals[arrived.message.stamp_ns] = arrived.at
            if len(self._arrivals) > MOST_ARRIVALS:
                del self._arrivals[next(iter(self._arrivals))]
        self._report_drops()
        try:
            frames = self._assembler.add(arrived.role, arrived.message)
        except Exception as error:
            self._refuse_after(error, f"a {arrived.role.value} message")
        else:
            self._fuse(frames)

    def _fuse(self, frames: list[Frame]) -> None:
        for frame in frames:
            self.counts.matched += 1
            arrival = self._arrivals.pop(frame.stamp_ns, time.monotonic())
            self._arrivals = {k: v for k, v in self._arrivals.items() if k > frame.stamp_ns}
            began = time.monotonic()
            try:
                scanned = self._scanner.fuse(frame)
            except FrameRefused as refusal:
                self._assembler.refuse(refusal)
                continue
            except Exception as error:
                self._refuse_after(error, f"the frame at {frame.stamp_ns / 1e9:.3f} s")
                continue
            self.counts.fusion_seconds = time.monotonic() - began
            self.last_frame = frame
            self.counts.redundant += scanned.fused.is_redundant
            self.counts.light_alone += scanned.fused.is_light_alone
            if scanned.keyframe is not None:
                self.counts.keyframes += 1
                self._on_keyframe(Keyframe(scanned.keyframe, arrival))  # first: it is waited for
                self.counts.take_light(self._scanner.scan)
            self.count_store()
            self.counts.fused += 1  # last: who reads it finds the other counts of the frame

    def _refuse_after(self, error: Exception, what: str) -> None:
        """Count an internal error: the node goes on with what comes next."""
        trace = "".join(traceback.format_exception(error)).rstrip()
        self._assembler.refuse(
            FrameRefused(
                RefusalCause.INTERNAL_ERROR,
                f"{what} was dropped after an internal error, please report it: {trace}",
            )
        )

    def _report_drops(self) -> None:
        with self._changed:
            count, self._unreported_drops = self._unreported_drops, 0
        if count:
            self._assembler.refuse(
                FrameRefused(
                    RefusalCause.QUEUE_FULL,
                    f"fusion is slower than the input: {self._queue_size} messages waited and "
                    "further ones were dropped; raise fusion.voxel_size, lower the camera's rate "
                    "or raise input.queue_size",
                    count,
                )
            )
