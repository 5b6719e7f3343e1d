# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A file with a summary is opened by it, without reading gigabytes of images first."""

import pytest

from benchmarks.scene.recording import Recording, recorded
from reflest_core.capture.formats.mcap_file import McapFile

FRAMES = 60


@pytest.fixture(scope="module")
def mcap(tmp_path_factory):
    bag = recorded(Recording(80, 60, FRAMES, 30.0), tmp_path_factory.mktemp("bag"))
    return next(bag.glob("*.mcap"))


def test_a_whole_summary_gives_the_counts_of_a_file_whose_middle_is_damaged(mcap, tmp_path):
    damaged = tmp_path / mcap.name
    content = bytearray(mcap.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 4096] = bytes(4096)
    damaged.write_bytes(content)
    assert {topic.count for topic in McapFile(damaged).topics} == {FRAMES}


def test_a_file_without_a_summary_is_counted_by_reading_it(mcap, tmp_path):
    cut = tmp_path / mcap.name
    cut.write_bytes(mcap.read_bytes()[: mcap.stat().st_size // 2])
    file = McapFile(cut)
    assert all(0 < topic.count < FRAMES for topic in file.topics)
    assert file.damage is not None
