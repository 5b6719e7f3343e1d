# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Requests for estimates are answered soon under overload, and with everything otherwise."""

from __future__ import annotations

import itertools
import threading
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from types import SimpleNamespace

import pytest
from view_input import estimate as made_estimate

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.messages import Role
from reflest_core.capture.settings import CaptureSettings
from reflest_core.estimation.estimator import NoEstimate
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_ros.services.estimate_requests import PATIENCE, EstimateRequests
from reflest_ros.workers.estimation_worker import EstimationWorker
from reflest_ros.workers.fusion_worker import FusionWorker

OLD, NEW = made_estimate(), made_estimate()
CLIENTS, MOST_WAITING = 10, 3
LATE = 60.0
"""Seconds that a machine which does much else may add."""
HELD = 300.0
"""Seconds after which an estimate that nobody lets end gives up."""


class Output:
    """Keeps the newest estimate, as the node's output does."""

    def __init__(self):
        self.latest = None

    def publish(self, keyframe, estimate):
        self.latest = estimate
        return estimate

    def fail(self, keyframe, error):
        raise AssertionError(error)

    def clear(self):
        self.latest = None


def crash(error):
    raise error


@pytest.fixture
def node():
    """Both threads; an estimate is made as soon as ``may_end`` is set."""
    may_end, output = threading.Event(), Output()

    def estimate(_):
        assert may_end.wait(HELD)
        return NEW

    estimation = EstimationWorker(estimate, output, crash)
    assembler = FrameAssembler(CaptureSettings())
    fusion = FusionWorker(assembler, Pipeline(ReflestSettings()), estimation.offer, crash, 10, 0.05)
    fusion.start()
    estimation.start()
    requests = EstimateRequests(fusion, estimation, output, MOST_WAITING)
    yield SimpleNamespace(fusion=fusion, may_end=may_end, output=output, requests=requests)
    may_end.set()
    fusion.stop()
    estimation.stop()


@pytest.fixture
def images(node):
    """Messages keep coming; none of them can be used."""
    is_over = threading.Event()

    def send():
        while not is_over.wait(0.02):
            node.fusion.offer(Role.POSE, SimpleNamespace(stamp_ns=0))

    feeding = threading.Thread(target=send)
    feeding.start()
    yield
    is_over.set()
    feeding.join()


def test_while_images_keep_coming_the_newest_estimate_is_the_answer(node, images):
    node.output.latest = OLD
    started = time.monotonic()
    answer = node.requests.now()
    assert time.monotonic() - started < PATIENCE + LATE
    assert answer.estimate is OLD
    assert "newest estimate so far" in answer.note


def test_ten_clients_at_once_are_answered_by_four_threads(node):
    """The first three would hold all others up. Who is alone at the end waits for its own."""
    node.output.latest = OLD
    with ThreadPoolExecutor(MOST_WAITING + 1) as pool:
        started = time.monotonic()
        answers = [pool.submit(node.requests.now) for _ in range(CLIENTS)]
        early = list(itertools.islice(as_completed(answers, HELD), CLIENTS - 1))
        assert time.monotonic() - started < PATIENCE + LATE
        assert all(answer.result().estimate is OLD for answer in early)
        node.may_end.set()


def test_alone_a_request_waits_for_its_own_estimate(node):
    node.output.latest = OLD
    threading.Timer(PATIENCE + 0.5, node.may_end.set).start()
    answer = node.requests.now()
    assert answer.estimate is NEW
    assert answer.note == ""


def test_the_first_estimate_of_a_scan_is_waited_for(node, images):
    threading.Timer(PATIENCE + 0.5, node.may_end.set).start()
    assert node.requests.now().estimate is NEW


def test_a_reason_for_no_estimate_is_the_answer(node):
    def nothing():
        raise NoEstimate("nothing was seen")

    node.fusion.snapshot = nothing
    with pytest.raises(NoEstimate, match="nothing was seen"):
        node.requests.now()
