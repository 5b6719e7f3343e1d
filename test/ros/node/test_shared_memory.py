# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Only what nobody uses any more is removed."""

from __future__ import annotations

import fcntl
import os
import time

import pytest

from reflest_ros.shared_memory import remove_left_segments, room_problem


@pytest.fixture
def segment(tmp_path):
    """Make a segment with its lock; the lock's open file."""
    held = []

    def one(name, age=3600.0):
        (tmp_path / f"fastrtps_{name}").write_bytes(bytes(100))
        lock = tmp_path / f"fastrtps_{name}_el"
        held.append(lock.open("wb"))
        os.utime(lock, (time.time() - age,) * 2)
        return held[-1]

    yield one
    for file in held:
        file.close()


def test_a_segment_in_use_stays_and_one_that_was_left_goes(segment, tmp_path):
    fcntl.flock(segment("used"), fcntl.LOCK_EX)
    segment("left")
    segment("port7411")
    (tmp_path / "other").write_bytes(b"")
    assert remove_left_segments(tmp_path) == 1
    assert {one.name for one in tmp_path.iterdir()} == {
        "fastrtps_used",
        "fastrtps_used_el",
        "fastrtps_port7411",
        "fastrtps_port7411_el",
        "other",
    }


def test_a_segment_that_is_just_being_made_stays(segment, tmp_path):
    segment("young", age=1.0)
    assert remove_left_segments(tmp_path) == 0
    assert (tmp_path / "fastrtps_young").exists()


def test_links_are_not_followed(tmp_path):
    victim = tmp_path / "victim"
    victim.write_text("precious")
    (tmp_path / "fastrtps_a").write_bytes(b"")
    (tmp_path / "fastrtps_a_el").symlink_to(victim)
    assert remove_left_segments(tmp_path) == 0
    assert victim.read_text() == "precious"


def test_a_small_container_is_named_with_what_to_do(tmp_path, monkeypatch):
    class State:
        f_frsize, f_blocks = 4096, 16384

    monkeypatch.setattr(os, "statvfs", lambda _: State)
    assert "67 MB" in room_problem(tmp_path)
    assert "--shm-size" in room_problem(tmp_path)
    State.f_blocks *= 8
    assert room_problem(tmp_path) == ""
