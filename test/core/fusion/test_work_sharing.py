# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Shared work gives what one thread gives, in order."""

import itertools
import threading

import hypothesis.strategies as st
import pytest
from hypothesis import given

from reflest_core.fusion import work_sharing
from reflest_core.fusion.frames import visibility
from reflest_core.fusion.observations import observation_store
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.tsdf import volume as tsdf
from reflest_core.fusion.work_sharing import share_out
from reflest_core.surface.observed_surface import SURFACE_ARRAYS
from test.core.fusion.analytic_scene import orbit_frames
from test.core.fusion.scan_state import assert_same_arrays, state_of


@given(st.integers(1, 5), st.integers(0, 100), st.integers(1, 40))
def test_every_item_once_and_in_order(threads, count, least):
    parts = share_out(threads, count, least, lambda start, stop: list(range(start, stop)))
    assert list(itertools.chain(*parts)) == list(range(count))
    assert 1 <= len(parts) <= threads
    assert len(parts) == 1 or min(map(len, parts)) >= least


def test_parts_run_at_the_same_time():
    meeting = threading.Barrier(2, timeout=600)
    assert share_out(2, 2, 1, lambda start, stop: (meeting.wait() >= 0, start)) == [
        (True, 0),
        (True, 1),
    ]


def test_a_part_that_no_thread_has_begun_is_done_by_the_caller():
    can_go_on = threading.Event()
    busy = work_sharing._pool(1).submit(can_go_on.wait, 60)
    assert share_out(2, 4, 1, lambda start, stop: (start, stop)) == [(0, 2), (2, 4)]
    assert not busy.done()
    can_go_on.set()
    assert busy.result()


def test_a_failing_part_is_reported():
    def fail(start, stop):
        raise OSError("part")

    with pytest.raises(OSError, match="part"):
        share_out(2, 10, 1, fail)


def test_a_scan_does_not_depend_on_the_number_of_threads(monkeypatch):
    for module in (tsdf, observation_store, visibility):
        monkeypatch.setattr(module, "LEAST_SHARE", 20)
    states, snapshots = [], []
    for threads in (1, 2, 3):
        scan = Scan(
            FusionSettings(max_depth=1.0, threads=threads, observations_per_voxel=5),
            RegionSettings(),
        )
        for frame in orbit_frames(8):
            scan.fuse(frame)
        states.append(state_of(scan))
        snapshots.append({name: getattr(scan.snapshot(), name) for name in SURFACE_ARRAYS})
    for others in (states, snapshots):
        for other in others[1:]:
            assert_same_arrays(others[0], other)
