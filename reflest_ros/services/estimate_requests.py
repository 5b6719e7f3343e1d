# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An estimate of everything that was scanned; under overload the newest one that there is."""

from __future__ import annotations

import threading
import time
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Protocol

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.pipeline import KeyframeSnapshot
from reflest_ros.workers.estimation_worker import EstimationWorker
from reflest_ros.workers.fusion_worker import FusionWorker, Keyframe

PATIENCE = 0.7
"""Seconds that a request waits for its own estimate while images or other requests keep coming."""
STEP = 0.1
"""Seconds after which it looks again whether they do."""


class LatestEstimate(Protocol):
    """Where the newest estimate of the present scan is kept."""

    latest: BrdfEstimate | None


@dataclass(frozen=True)
class AnsweredEstimate:
    """An estimate, and what has to be said of it.

    Attributes:
        estimate: Of the scan.
        note: Why it is not of everything that was scanned, as a clause, or "".
    """

    estimate: BrdfEstimate
    note: str = ""


class EstimateRequests:
    """Answers requests for an estimate from several threads at once.

    A request gets an estimate of everything that was scanned before it. While images keep coming,
    or other requests wait too, it waits :data:`PATIENCE` at most and then gets the newest
    estimate of this scan; its own is published when it is there. The first estimate of a scan is
    always waited for.
    """

    def __init__(
        self,
        fusion: FusionWorker,
        estimation: EstimationWorker,
        output: LatestEstimate,
        most_waiting: int,
    ) -> None:
        """Begin without a request.

        Args:
            fusion: The thread that the scan belongs to.
            estimation: Estimates from it.
            output: Has the newest estimate.
            most_waiting: Requests that may wait at once; further ones get the newest estimate
                immediately, so that one thread is always left to answer.
        """
        self._fusion, self._estimation, self._output = fusion, estimation, output
        self._most_waiting = most_waiting
        self._lock = threading.Lock()
        self._waiting = 0

    def now(self) -> AnsweredEstimate:
        """Estimate from everything that was scanned.

        Returns:
            That estimate, or under overload the newest one.

        Raises:
            ReflestError: There is no estimate; the sentence says why.
        """
        with self._lock:
            self._waiting += 1
            is_crowded = self._waiting > self._most_waiting
        try:
            if is_crowded and (known := self._output.latest) is not None:
                return _earlier(known)
            return self._waited_for(self._asked())
        finally:
            with self._lock:
                self._waiting -= 1

    def _asked(self) -> Future[BrdfEstimate]:
        """Ask the fusion thread for the scan, and then the estimation thread for its estimate."""
        answer: Future[BrdfEstimate] = Future()
        asked = time.monotonic()

        def estimated(done: Future[BrdfEstimate]) -> None:
            if (error := done.exception()) is not None:
                answer.set_exception(error)
            else:
                answer.set_result(done.result())

        def copied(done: Future[KeyframeSnapshot]) -> None:
            if (error := done.exception()) is not None:
                answer.set_exception(error)
            else:
                request = self._estimation.request(Keyframe(done.result(), asked))
                request.add_done_callback(estimated)

        self._fusion.call(self._fusion.snapshot).add_done_callback(copied)
        return answer

    def _waited_for(self, answer: Future[BrdfEstimate]) -> AnsweredEstimate:
        wait = PATIENCE
        while True:
            try:
                return AnsweredEstimate(answer.result(wait))
            except TimeoutError:
                if answer.done():  # it came meanwhile, or the work itself ran out of time
                    return AnsweredEstimate(answer.result())
            is_busy = self._fusion.is_receiving or self._waiting > 1
            if is_busy and (known := self._output.latest) is not None:
                return _earlier(known)
            wait = STEP


def _earlier(estimate: BrdfEstimate) -> AnsweredEstimate:
    return AnsweredEstimate(
        estimate,
        f"the newest estimate so far, of the image at {estimate.stamp_ns / 1e9:.3f} s, for the "
        "node is busy: the next one is published when it is there",
    )
