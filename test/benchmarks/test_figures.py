# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The arithmetic between a measurement and what is published."""

from __future__ import annotations

import itertools
import mmap
import sys
import time

import pytest

from benchmarks.live.message_account import TimedEstimate, account
from benchmarks.measuring.resident_memory import forget_peak, peak_mb, resident_mb
from benchmarks.measuring.stage_clock import Stage, StageClock, StageMoved
from benchmarks.measuring.timing import Timing
from benchmarks.report.table import number, table
from benchmarks.run import compare_with_open3d
from reflest_core.capture import pose


def test_percentiles_are_in_milliseconds():
    timing = Timing.of("stage", [0.001 * n for n in range(101)])
    assert (timing.count, timing.p50_ms, timing.p95_ms, timing.p99_ms, timing.mean_ms) == (
        pytest.approx((101, 50.0, 95.0, 99.0, 50.0))
    )


def test_a_stage_sums_its_calls_of_a_lap_and_is_unwrapped_afterwards():
    original = time.perf_counter_ns
    clock = StageClock([Stage("ticks", ("time:perf_counter_ns",))])
    with clock.watching():
        for _ in range(3):
            time.perf_counter_ns()
        clock.lap()
        clock.lap()
    assert len(clock.seconds["ticks"]) == 1
    assert time.perf_counter_ns is original


def outer():
    return inner()


def inner():
    return 1


def test_a_stage_whose_functions_call_each_other_is_counted_once(monkeypatch):
    ticks = itertools.count()
    monkeypatch.setattr("time.perf_counter", lambda: next(ticks))
    clock = StageClock([Stage("both", (f"{__name__}:outer", f"{__name__}:inner"))])
    with clock.watching():
        assert sys.modules[__name__].outer() == 1
        clock.lap()
    assert clock.seconds["both"] == [1]


@pytest.mark.parametrize("place", ["reflest_core.nowhere:f", "reflest_core.capture.pose:Gone.f"])
def test_a_stage_that_moved_says_where_to_name_its_new_place(place):
    assert not hasattr(pose, "Gone")
    clock = StageClock([Stage("decode", (place,))])
    with pytest.raises(StageMoved, match=r"'decode'.*measurements/stages\.py"), clock.watching():
        pass


def test_peak_memory_sees_what_was_given_back():
    if not forget_peak():
        pytest.skip("this kernel does not let a process forget its peak")
    before = resident_mb()
    # Straight from the system: the allocator may have pages left of what ran before.
    with mmap.mmap(-1, 50_000_000) as pages:
        pages.write(bytes(50_000_000))
    assert peak_mb() - before > 40.0


def test_ours_and_open3d_are_compared_over_common_frames_alone():
    path = {"fuse_ms": {"1": 10.0, "2": 20.0, "3": 1000.0}}
    peers = {"colour": {"integrate_ms": {"1": 40.0, "2": 80.0}}}
    compared = compare_with_open3d(path, peers)["colour"]
    assert compared["frames"] == 2
    assert compared["p50"] == {"fuse_ms": 15.0, "open3d_ms": 60.0, "ratio": 0.25}


def test_lost_messages_are_counted_by_cause():
    diagnostics = {
        "messages rgb": "98",
        "messages depth": "100",
        "messages camera_info": "100",
        "messages pose": "99",
        "refused queue_full": "4",
        "refused pose_missing": "2",
        "frames matched": "97",
        "frames fused": "97",
        "frames redundant": "5",
        "voxels": "7",
    }
    estimates = [TimedEstimate(5.0, 0.01, 0.0), TimedEstimate(7.0, 0.03, 0.2)]
    found = account(100, diagnostics, estimates)
    assert found["messages_lost"] == {"on the way (DDS)": 3, "queue_full": 4}
    assert found["refused"] == {"pose_missing": 2}
    assert (found["frames_fused"], found["frames_redundant"], found["frames_lost"]) == (92, 5, 3)
    assert found["messages_sent"] == 400
    assert found["messages_received"] == 397
    assert found["latency"]["p50_ms"] == pytest.approx(20.0)
    assert found["slowest"][0] == pytest.approx(
        {"latency_ms": 30.0, "at_s": 2.0, "stolen_ms": 200.0}
    )
    assert found["stolen_s"] == pytest.approx(0.2)


def test_without_an_estimate_there_is_no_latency():
    assert account(1, {}, [])["latency"] is None


def test_numbers_keep_three_digits():
    assert [number(value) for value in (0.1234, 12.34, 1234.5, None)] == [
        "0.12",
        "12.3",
        "1,234",
        "-",
    ]


def test_a_table_is_markdown():
    assert table(("stage", "ms"), [("decode", "1.0")]) == (
        "| stage | ms |\n| --- | ---: |\n| decode | 1.0 |\n"
    )
