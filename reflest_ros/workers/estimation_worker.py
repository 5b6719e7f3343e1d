# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The thread that estimates while frames keep coming."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import Protocol

from reflest_core.errors import ReflestError
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.scanner import KeyframeSnapshot
from reflest_ros.workers.fusion_worker import Keyframe
from reflest_ros.workers.worker_thread import worker_thread

Estimate = Callable[[KeyframeSnapshot], BrdfEstimate]


class Output(Protocol):
    """Where estimates go; no two of its methods run at once."""

    def publish(self, keyframe: Keyframe, estimate: BrdfEstimate) -> BrdfEstimate:
        """Send an estimate; return what was sent."""

    def fail(self, keyframe: Keyframe, error: ReflestError) -> None:
        """Hear of a keyframe without an estimate."""

    def clear(self) -> None:
        """Forget what was sent."""


class EstimationWorker:
    """Estimates the newest keyframe and whatever is asked for.

    A keyframe that comes before the last one was begun takes its place: the topic shows the state
    of the scan, not its history. ``skipped`` counts these.
    """

    def __init__(
        self, estimate: Estimate, output: Output, on_crash: Callable[[BaseException], None]
    ) -> None:
        self.skipped = 0
        self._estimate = estimate
        self._output = output
        self._output_lock = threading.Lock()
        self._changed = threading.Condition()
        self._keyframe: Keyframe | None = None
        self._requests: deque[tuple[Keyframe, Future[BrdfEstimate]]] = deque()
        self._generation = 0
        self._is_stopped = False
        self._thread = worker_thread("estimation", self._run, on_crash)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread after the estimate in hand."""
        with self._changed:
            self._is_stopped = True
            self._changed.notify()
        self._thread.join()

    def offer(self, keyframe: Keyframe) -> None:
        """Estimate this keyframe next."""
        with self._changed:
            self.skipped += self._keyframe is not None
            self._keyframe = keyframe
            self._changed.notify()

    def request(self, keyframe: Keyframe) -> Future[BrdfEstimate]:
        """Estimate this snapshot before any keyframe; the future has the estimate or the reason."""
        future: Future[BrdfEstimate] = Future()
        with self._changed:
            if self._is_stopped:
                future.set_exception(_shutting_down())
                return future
            self._requests.append((keyframe, future))
            self._changed.notify()
        return future

    def forget(self) -> None:
        """Publish nothing of what was scanned before this call, and clear what was shown."""
        with self._changed:
            self._keyframe = None
            self._generation += 1
        with self._output_lock:
            self._output.clear()

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._is_stopped or self._requests or self._keyframe)
                generation = self._generation
                future = None
                if self._is_stopped:
                    break
                if self._requests:
                    keyframe, future = self._requests.popleft()
                elif self._keyframe is not None:
                    keyframe, self._keyframe = self._keyframe, None
            self._work(keyframe, future, generation)
        for _, future in self._requests:
            future.set_exception(_shutting_down())

    def _work(
        self, keyframe: Keyframe, future: Future[BrdfEstimate] | None, generation: int
    ) -> None:
        try:
            estimate = self._estimate(keyframe.snapshot)
        except ReflestError as error:
            if future is not None:
                future.set_exception(error)
                return
            with self._output_lock:
                if generation == self._generation:
                    self._output.fail(keyframe, error)
            return
        with self._output_lock:
            if generation == self._generation:
                estimate = self._output.publish(keyframe, estimate)
        if future is not None:
            future.set_result(estimate)


def _shutting_down() -> ReflestError:
    return ReflestError("the estimator is shutting down")
