# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The bag player: whole, cut off and unusable bags."""

from __future__ import annotations

import pytest
from sphere_messages import RGB

from reflest_ros.srv import Estimate


def test_a_truncated_bag_is_played_as_far_as_it_goes(node, peer, start, sphere_bag, tmp_path):
    whole = (sphere_bag / f"{sphere_bag.name}.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[: len(whole) // 2])
    player = start("reflest_ros.bag_player", cut)
    assert player.exit_code() == 0, player.output
    (warning,) = player.lines_with("reflest: warning:")
    assert "cut.mcap is damaged" in warning
    peer.wait_for_count("frames fused", 1)
    response = peer.call(Estimate, "estimate")
    assert response.success, response.message
    assert node.is_running


@pytest.mark.parametrize(
    ("name", "content"), [("missing.mcap", None), ("text.mcap", b"no bag"), ("a.txt", b"no bag")]
)
def test_what_is_no_bag_is_named_in_one_sentence(start, tmp_path, name, content):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    player = start("reflest_ros.bag_player", path)
    assert player.exit_code() == 2
    assert len(player.lines) == 1
    assert name in player.output
    assert player.output.startswith("reflest: error:")


def test_a_topic_that_is_not_recorded_is_named(start, sphere_bag):
    player = start("reflest_ros.bag_player", sphere_bag, "--topics", "/nothing")
    assert player.exit_code() == 2
    assert "/nothing" in player.output
    assert RGB in player.output


def test_without_a_subscriber_it_says_what_to_start(start, sphere_bag):
    player = start(
        "reflest_ros.bag_player",
        sphere_bag,
        "--topics",
        RGB,
        "--wait",
        "0.2",
        "--ros-args",
        "-r",
        f"{RGB}:=/nobody/listens",
    )
    assert player.exit_code() == 2
    assert "start the estimator" in player.output
