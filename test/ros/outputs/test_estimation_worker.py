# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The thread that estimates, without DDS: what is skipped, forgotten, and what a crash does."""

from __future__ import annotations

import dataclasses
import threading

import pytest
from view_input import ESTIMATE

from reflest_core.errors import ReflestError
from reflest_core.estimation.estimator import NoEstimate
from reflest_core.estimation.pipeline import KeyframeSnapshot
from reflest_ros.workers.estimation_worker import EstimationWorker
from reflest_ros.workers.fusion_worker import Keyframe
from test.waiting import PATIENCE, wait_until


class Published:
    """Collects what an EstimationWorker gives out."""

    def __init__(self):
        self.estimates = []
        self.failures = []
        self.cleared = 0
        self.crashes = []
        self.crashed = threading.Event()

    def publish(self, keyframe, estimate):
        self.estimates.append((estimate, keyframe.arrival))
        return estimate

    def fail(self, keyframe, error):
        self.failures.append(error)

    def clear(self):
        self.cleared += 1

    def crash(self, error):
        self.crashes.append(error)
        self.crashed.set()


def keyframe(number):
    return Keyframe(KeyframeSnapshot(number, "", None), float(number))


def held_estimate():
    """An estimate that says when it begins, and ends when it is released."""
    begun, release = threading.Event(), threading.Event()

    def estimate(snapshot):
        begun.set()
        release.wait(PATIENCE)
        return ESTIMATE

    return begun, release, estimate


@pytest.fixture
def estimating():
    published = Published()
    workers = []

    def start(estimate, *offered):
        worker = EstimationWorker(estimate, published, published.crash)
        for number in offered:
            worker.offer(keyframe(number))
        worker.start()
        workers.append(worker)
        return worker, published

    yield start
    for worker in workers:
        worker.stop()


def test_the_newest_keyframe_takes_the_place_of_those_that_wait(estimating):
    worker, published = estimating(lambda snapshot: (ESTIMATE, snapshot.stamp_ns), 1, 2, 3)
    worker.request(keyframe(9)).result(PATIENCE)
    worker.request(keyframe(10)).result(PATIENCE)
    # Requests go before keyframes.
    wait_until(lambda: len(published.estimates) == 3, "the keyframe was not estimated")
    worker.stop()
    stamps = {estimate[1] for estimate, _ in published.estimates}
    assert stamps == {3, 9, 10}
    assert worker.skipped == 2


def test_what_was_scanned_before_a_reset_is_not_published_after_it(estimating):
    begun, release, estimate = held_estimate()
    worker, published = estimating(estimate, 1)
    assert begun.wait(PATIENCE)
    worker.offer(keyframe(2))
    worker.forget()
    release.set()
    worker.request(keyframe(3)).result(PATIENCE)
    assert [arrival for _, arrival in published.estimates] == [3.0]
    assert published.cleared == 1


def test_no_estimate_is_a_failure_at_a_keyframe_and_an_answer_to_a_request(estimating):
    def estimate(snapshot):
        raise NoEstimate("nothing was seen")

    worker, published = estimating(estimate, 1)
    with pytest.raises(NoEstimate, match="nothing was seen"):
        worker.request(keyframe(2)).result(PATIENCE)
    worker.stop()
    assert len(published.failures) <= 1
    assert published.estimates == []
    assert not published.crashes


def test_an_internal_error_ends_a_future_and_the_next_keyframe_is_estimated(estimating):
    def estimate(snapshot):
        if snapshot.stamp_ns < 3:
            raise ZeroDivisionError
        return ESTIMATE

    worker, published = estimating(estimate)
    with pytest.raises(ZeroDivisionError):
        worker.request(keyframe(1)).result(PATIENCE)
    worker.offer(keyframe(2))
    assert worker.request(keyframe(3)).result(PATIENCE) is ESTIMATE
    worker.stop()
    assert [type(error) for error in published.failures] in ([], [ZeroDivisionError])
    assert not published.crashes


def test_requests_that_wait_together_get_one_estimate_of_the_newest(estimating):
    """Ten clients that ask at once wait for two estimates at most, not for ten."""
    begun, release, estimated = threading.Event(), threading.Event(), []

    def estimate(snapshot):
        estimated.append(snapshot.stamp_ns)
        begun.set()
        release.wait(PATIENCE)
        return ESTIMATE

    worker, published = estimating(estimate)
    first = worker.request(keyframe(1))
    assert begun.wait(PATIENCE)
    asked = [dataclasses.replace(keyframe(k), arrival=float(k)) for k in range(2, 12)]
    waiting = [worker.request(one) for one in [*asked[5:], *asked[:5]]]
    release.set()
    assert all(future.result(PATIENCE) is ESTIMATE for future in (first, *waiting))
    worker.stop()
    assert estimated == [1, 11]
    assert not published.crashes


def test_a_request_that_waits_when_the_worker_stops_is_answered(estimating):
    begun, release, estimate = held_estimate()
    worker, _ = estimating(estimate)
    first = worker.request(keyframe(1))
    assert begun.wait(PATIENCE)
    waiting = worker.request(keyframe(2))
    stopping = threading.Thread(target=worker.stop)
    stopping.start()
    wait_until(lambda: worker.call(lambda: None).done(), "it takes requests while it stops")
    release.set()
    stopping.join(PATIENCE)
    assert first.result(PATIENCE) is ESTIMATE
    with pytest.raises(ReflestError, match="shutting down"):
        waiting.result(PATIENCE)


def test_a_stop_does_not_wait_for_a_long_estimate_which_is_not_published(estimating):
    begun, release, estimate = held_estimate()
    worker, published = estimating(estimate, 1)
    assert begun.wait(PATIENCE)
    request = worker.request(keyframe(2))
    worker.stop()
    assert worker._thread.is_alive(), "it waited for the estimate"
    with pytest.raises(ReflestError, match="shutting down"):
        request.result(0)
    release.set()
    worker._thread.join(PATIENCE)
    assert worker.discarded == 1
    assert published.estimates == published.failures == published.crashes == []
