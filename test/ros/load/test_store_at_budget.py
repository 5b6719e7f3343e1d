# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A store that fills its budget says so, and goes on with the surface that it sees."""

from __future__ import annotations

import pytest
from feed import SOON, Feed


@pytest.fixture(scope="module")
def node(start, settings_file):
    """Voxels of 3 mm over the whole table are more than 16 MB hold."""
    process = start(
        "reflest_ros.estimator",
        "--ros-args",
        "--params-file",
        settings_file,
        "-p",
        "fusion.voxel_size:=0.003",
        "-p",
        "fusion.memory_budget_mb:=16.0",
        "-p",
        "region.shape:=none",
    )
    process.wait_for_line("listening to", 600.0)
    return process


def test_it_is_warned_of_once_and_the_next_frames_are_fused(feed: Feed):
    peer = feed.peer
    feed.send_good()
    warning = feed.node.wait_for_line(r"\(cause: store_full; logged once\)", SOON)
    for words in ("its budget of 16 MB", "fusion.memory_budget_mb"):
        assert words in warning
    peer.wait_until(lambda: "its budget of 16 MB" in peer.state, "not in the state", SOON)
    for _ in range(8):
        feed.send_good()
    assert float(peer.diagnostics["store (MB)"]) <= 16.0
    assert len(feed.node.lines_with("cause: store_full;")) == 1
    assert not [key for key in peer.diagnostics if key.startswith("refused")]
