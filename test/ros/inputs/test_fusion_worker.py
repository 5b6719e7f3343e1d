# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The thread that fuses, without DDS: what is dropped, forgotten, and what a crash does."""

from __future__ import annotations

import dataclasses
import threading
import time

import numpy as np
import pytest
from sphere_messages import camera_info_message, depth_message, pose_message, rgb_message
from sphere_scene import views

from reflest_core.capture.assembler import FrameAssembler
from reflest_core.capture.messages import Role
from reflest_core.capture.refusal import RefusalCause
from reflest_core.capture.settings import CaptureSettings
from reflest_core.errors import ReflestError
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_ros.inputs import core_messages
from reflest_ros.workers.fusion_worker import FusionWorker
from test.waiting import PATIENCE, wait_until


def crash_is_failure(error):
    raise error


@pytest.fixture
def new_worker():
    """Make a worker that is not started yet, by default with room for 8 messages."""
    workers = []

    def make(assembler=None, pipeline=None, on_keyframe=lambda _: None, queue_size=8):
        worker = FusionWorker(
            assembler or FrameAssembler(CaptureSettings()),
            pipeline or Pipeline(ReflestSettings()),
            on_keyframe,
            crash_is_failure,
            queue_size=queue_size,
            settle_after=0.05,
        )
        workers.append(worker)
        return worker

    yield make
    for worker in workers:
        worker.stop()


@pytest.fixture
def fusion(new_worker):
    """A worker, its assembler and its keyframes."""
    settings = ReflestSettings.from_values({"fusion": {"voxel_size": 0.02}})
    assembler = FrameAssembler(CaptureSettings())
    keyframes = []
    return new_worker(assembler, Pipeline(settings), keyframes.append), assembler, keyframes


def offer(worker, view):
    worker.offer(Role.POSE, core_messages.pose_message(pose_message(view)))
    worker.offer(Role.CAMERA_INFO, core_messages.camera_info_message(camera_info_message(view)))
    worker.offer(Role.DEPTH, core_messages.image_message(depth_message(view)))
    worker.offer(Role.RGB, core_messages.image_message(rgb_message(view)))


def test_what_finds_no_room_is_dropped_counted_and_said(fusion):
    worker, assembler, keyframes = fusion
    for view in views(3):
        offer(worker, view)
    worker.start()
    assert worker.call(lambda: worker.counts.fused).result(PATIENCE) == 2
    assert worker.counts.dropped == 4
    assert assembler.refusals.counts[RefusalCause.QUEUE_FULL] == 4
    assert "input.queue_size" in assembler.refusals.first_message[RefusalCause.QUEUE_FULL]
    assert keyframes[0].snapshot.stamp_ns == next(views(1)).stamp_ns


def test_a_keyframe_is_handed_on_before_anything_is_counted(new_worker):
    voxels = []
    worker = new_worker(on_keyframe=lambda _: voxels.append(worker.counts.voxels))
    offer(worker, next(views(1)))
    worker.start()
    assert worker.call(lambda: worker.counts.voxels).result(PATIENCE) > 0
    assert voxels == [0]


def test_a_job_runs_after_what_came_before_it_and_its_error_reaches_the_caller(fusion):
    worker, _, _ = fusion
    offer(worker, next(views(1)))
    fused = worker.call(lambda: worker.counts.fused)
    failed = worker.call(lambda: np.zeros(1)[2])
    worker.start()
    assert fused.result(PATIENCE) == 1
    with pytest.raises(IndexError):
        failed.result(PATIENCE)
    assert worker.call(lambda: "alive").result(PATIENCE) == "alive"


def test_an_image_without_partners_is_decided_when_messages_stop(new_worker):
    refused = threading.Event()
    assembler = FrameAssembler(
        CaptureSettings(), on_refusal=lambda refusal, is_first: refused.set()
    )
    worker = new_worker(assembler)
    first, second = views(2)
    offer(worker, first)
    worker.offer(Role.RGB, core_messages.image_message(rgb_message(second)))
    worker.start()
    assert refused.wait(PATIENCE)
    assert worker.call(lambda: worker.counts.fused).result(PATIENCE) == 1
    worker.stop()
    assert assembler.refusals.counts.total() == 1


def test_a_job_that_waits_when_the_worker_stops_is_answered(new_worker):
    worker = new_worker()
    blocked, release = threading.Event(), threading.Event()

    def block():
        blocked.set()
        release.wait(PATIENCE)

    worker.start()
    worker.call(block)
    assert blocked.wait(PATIENCE)
    waiting = worker.call(lambda: "too late")
    stopping = threading.Thread(target=worker.stop)
    stopping.start()
    wait_until(lambda: worker.call(lambda: None).done(), "it takes requests while it stops")
    release.set()
    stopping.join(PATIENCE)
    with pytest.raises(ReflestError, match="shutting down"):
        waiting.result(PATIENCE)


SLOW = 0.1
"""Seconds that a frame takes at least."""
MANY = 20
"""Frames that wait."""


class SlowPipeline:
    """Takes a while for each frame, as a slow computer does."""

    def __init__(self, seconds):
        self._scanner = Pipeline(ReflestSettings())
        self._seconds = seconds

    def fuse(self, frame):
        time.sleep(self._seconds)
        return self._scanner.fuse(frame)

    def __getattr__(self, name):
        return getattr(self._scanner, name)


def test_a_request_is_answered_soon_while_more_comes_than_can_be_fused(new_worker):
    worker = new_worker(pipeline=SlowPipeline(SLOW), queue_size=400)
    start = next(views(1)).stamp_ns
    known = list(views(12))
    is_over = threading.Event()

    def flood():
        sent = 0
        while not is_over.wait(0.01):
            sent += 1
            offer(worker, dataclasses.replace(known[sent % 12], stamp_ns=start + sent * 10_000_000))

    feeding = threading.Thread(target=flood)
    worker.start()
    feeding.start()
    try:
        wait_until(lambda: worker.waiting > 4 * MANY, "fusion is not slower than the input")
        answer = worker.call(lambda: worker.counts.fused)
        asked_after = worker.counts.fused
        # In its patience it can fuse five more, and on a slower computer fewer.
        assert answer.result(PATIENCE) - asked_after < MANY / 2
        assert worker.call_now(lambda: "at once").result(PATIENCE) == "at once"
    finally:
        is_over.set()
        feeding.join()


def test_a_request_waits_for_everything_when_nothing_more_comes(new_worker):
    worker = new_worker(pipeline=SlowPipeline(SLOW), queue_size=400)
    for view in views(12):
        offer(worker, view)
    worker.start()
    assert worker.call(lambda: worker.counts.fused).result(PATIENCE) == 12


def test_a_reset_drops_and_counts_what_waits(fusion):
    worker, _, _ = fusion
    for view in views(2):
        offer(worker, view)
    reset = worker.call_now(worker.reset)
    worker.start()
    reset.result(PATIENCE)
    assert worker.call(lambda: worker.counts.fused).result(PATIENCE) == 0
    assert worker.counts.discarded == 8


def test_an_internal_error_in_fusion_refuses_the_frame_and_the_scan_continues(fusion):
    worker, assembler, _ = fusion
    first, second = views(2)
    fuse = worker._scanner.fuse

    def broken(frame):
        worker._scanner.fuse = fuse
        raise ZeroDivisionError("broken")

    worker._scanner.fuse = broken
    offer(worker, first)
    offer(worker, second)
    worker.start()
    assert worker.call(lambda: worker.counts.fused).result(PATIENCE) == 1
    assert assembler.refusals.counts[RefusalCause.INTERNAL_ERROR] == 1
    assert "broken" in assembler.refusals.first_message[RefusalCause.INTERNAL_ERROR]
