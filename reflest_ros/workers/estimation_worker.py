# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The thread that estimates while frames keep coming."""

from __future__ import annotations

import functools
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, Protocol, TypeVar

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.pipeline import KeyframeSnapshot
from reflest_ros.threads import resolve, shutting_down, worker_thread
from reflest_ros.workers.fusion_worker import Keyframe

T = TypeVar("T")
Estimate = Callable[[KeyframeSnapshot], BrdfEstimate]
LONGEST_STOP = 0.5
"""Seconds that a transition waits for the estimate that is being made."""
MakeMaterials = Callable[[], Callable[[], None] | None]


class Output(Protocol):
    """Where estimates go; no two of its methods run at once."""

    def publish(self, keyframe: Keyframe, estimate: BrdfEstimate) -> BrdfEstimate:
        """Send an estimate and return it as it was sent.

        Args:
            keyframe: the scan that it belongs to.
            estimate: the keyframe's estimate.
        """

    def fail(self, keyframe: Keyframe, error: Exception) -> None:
        """Take note of a keyframe without an estimate.

        Args:
            keyframe: the scan that it belongs to.
            error: what went wrong.
        """

    def clear(self) -> None:
        """Replace everything that was sent by what stands for nothing."""


class EstimationWorker:
    """Estimates the newest keyframe and whatever is asked for.

    A keyframe that comes before the last one was begun takes its place: the topic shows the state
    of the scan, not its history. Requests that wait at the same time get one estimate, of the
    newest snapshot among theirs, so that none waits for those of others.

    Attributes:
        skipped: Keyframes that a newer one replaced.
        discarded: Keyframes that were dropped because their scan was left.
    """

    def __init__(
        self,
        estimate: Estimate,
        output: Output,
        on_crash: Callable[[BaseException], None],
        materials: MakeMaterials = lambda: None,
    ) -> None:
        """Prepare the thread.

        Args:
            estimate: Makes an estimate of a snapshot.
            output: Publishes it.
            on_crash: Called with what ended the thread.
            materials: Makes a material map after an estimate, while nothing waits; it returns
                what publishes the map, or None.
        """
        self.skipped = 0
        self.discarded = 0
        self._estimate = estimate
        self._materials = materials
        self._output = output
        self._output_lock = threading.Lock()
        self._changed = threading.Condition()
        self._keyframe: Keyframe | None = None
        self._are_materials_due = False
        self._requests: deque[tuple[Keyframe, Future[BrdfEstimate]]] = deque()
        self._jobs: deque[tuple[Callable[[], Any], Future[Any]]] = deque()
        self._generation = 0
        self._is_stopped = False
        self._thread = worker_thread("estimation", self._run, on_crash)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread after the current estimate; the futures of waiting requests fail.

        An estimate that takes longer than :data:`LONGEST_STOP` goes on alone and is not published.
        """
        with self._changed:
            self._is_stopped = True
            self._changed.notify()
        if self._thread.ident is not None:
            self._thread.join(LONGEST_STOP)
        if self._thread.is_alive():
            with self._output_lock, self._changed:
                self._generation += 1
        for waiting in (self._requests, self._jobs):
            while waiting:
                waiting.popleft()[1].set_exception(shutting_down())

    def offer(self, keyframe: Keyframe) -> None:
        """Estimate this keyframe next.

        Args:
            keyframe: The newest one.
        """
        with self._changed:
            self.skipped += self._keyframe is not None
            self._keyframe = keyframe
            self._changed.notify()

    def request(self, keyframe: Keyframe) -> Future[BrdfEstimate]:
        """Estimate this snapshot, or a newer one of another request, before any keyframe.

        Args:
            keyframe: The snapshot with the time of the request.

        Returns:
            A future with the estimate or with the reason that there is none; it always ends.
        """
        future: Future[BrdfEstimate] = Future()
        with self._changed:
            if self._is_stopped:
                future.set_exception(shutting_down())
                return future
            self._requests.append((keyframe, future))
            self._changed.notify()
        return future

    def call(self, work: Callable[[], T]) -> Future[T]:
        """Run something in this thread, before any keyframe.

        Args:
            work: What nothing else may run beside.

        Returns:
            A future with its result or exception; it always ends.
        """
        future: Future[T] = Future()
        with self._changed:
            if self._is_stopped:
                future.set_exception(shutting_down())
                return future
            self._jobs.append((work, future))
            self._changed.notify()
        return future

    def forget(self) -> None:
        """Publish nothing of what was scanned before this call, and clear what was published."""
        with self._changed:
            self.discarded += self._keyframe is not None
            self._keyframe = None
            self._generation += 1
        with self._output_lock:
            self._output.clear()

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(self._has_work)
                if self._is_stopped:
                    return
                generation, keyframe = self._generation, None
                waiting: list[tuple[Keyframe, Future[BrdfEstimate]]] = []
                job = self._jobs.popleft() if self._jobs else None
                if job is None and self._requests:
                    waiting = list(self._requests)
                    self._requests.clear()
                    keyframe = max((one for one, _ in waiting), key=lambda one: one.arrival)
                elif job is None and self._keyframe is not None:
                    keyframe, self._keyframe = self._keyframe, None
                if job is None:
                    self._are_materials_due = keyframe is not None
            if job is not None:
                resolve([job[1]], job[0])
                continue
            if keyframe is None:
                self._publish_materials(generation)
                continue
            if waiting:
                futures = [future for _, future in waiting]
                resolve(futures, functools.partial(self._published, keyframe, generation))
            else:
                self._work(keyframe, generation)

    def _publish_materials(self, generation: int) -> None:
        """Make a material map, and publish it unless its scan was left meanwhile."""
        publish = self._materials()
        if publish is not None:
            with self._output_lock:
                if generation == self._generation:
                    publish()

    def _has_work(self) -> bool:
        return bool(
            self._is_stopped
            or self._jobs
            or self._requests
            or self._keyframe
            or self._are_materials_due
        )

    def _work(self, keyframe: Keyframe, generation: int) -> None:
        try:
            self._published(keyframe, generation)
        except Exception as error:  # the node goes on with the next keyframe
            with self._output_lock:
                if generation == self._generation:
                    self._output.fail(keyframe, error)

    def _published(self, keyframe: Keyframe, generation: int) -> BrdfEstimate:
        """The estimate, published unless its scan was left meanwhile."""
        estimate = self._estimate(keyframe.snapshot)
        with self._output_lock:
            if generation == self._generation:
                return self._output.publish(keyframe, estimate)
            self.discarded += 1
        return estimate
