# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Starting, stopping and silence."""

from __future__ import annotations

import signal

import pytest
from own_process import ROOT
from sphere_messages import DEPTH, POSE, messages_of, write_bag
from sphere_scene import views

from reflest_ros.srv import Estimate


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_in_mid_scan_ends_the_node_cleanly(start, settings_file, sphere_bag, number):
    node = start("reflest_ros.estimator", "--ros-args", "--params-file", settings_file)
    node.wait_for_line("listening to", 600.0)
    player = start("reflest_ros.bag_player", sphere_bag, "--rate", "0.5")
    node.wait_for_line("first estimate")
    node.interrupt(number)
    assert node.exit_code() == 0, node.output
    assert "Traceback" not in node.output
    player.interrupt()
    assert player.exit_code() == 0, player.output
    assert "Traceback" not in player.output


def test_a_signal_while_the_node_starts_ends_it_cleanly(start):
    node = start("reflest_ros.estimator")
    node.wait_for_line("starting")
    node.interrupt()
    assert node.exit_code(600.0) == 0, node.output
    assert "Traceback" not in node.output


def test_a_missing_topic_is_named_in_one_warning(start, peer, settings_file, tmp_path):
    bag = write_bag(
        tmp_path / "no_depth",
        (
            (view.stamp_ns, topic, message)
            for view in views(4)
            for topic, message in messages_of(view)
            if topic != DEPTH
        ),
    )
    node = start(
        "reflest_ros.estimator",
        "--ros-args",
        "--params-file",
        settings_file,
        "-p",
        "input.silence:=0.5",
    )
    node.wait_for_line("listening to", 600.0)
    player = start("reflest_ros.bag_player", bag)
    assert player.exit_code() == 0, player.output
    warning = node.wait_for_line("no message for 0.5 s")
    assert DEPTH in warning
    assert "no publisher" in warning
    response = peer.call(Estimate, "estimate")
    assert not response.success
    assert node.is_running


def test_base_file_namespace_and_remapping_name_the_topics(start):
    node = start(
        "reflest_ros.estimator",
        "--ros-args",
        "--params-file",
        ROOT / "config" / "estimator.yaml",
        "-r",
        "rgb:=/left/image",
        "-r",
        "__ns:=/robot1",
    )
    line = node.wait_for_line("listening to", 600.0)
    assert "/left/image" in line
    assert f"/robot1{POSE}" in line
    assert "/robot1/reflectance/brdf" in line
