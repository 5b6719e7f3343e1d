# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the node says about a scan that goes on: rates, silence, exposure and a full store."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from feed import SOON
from sphere_messages import RGB, messages_of
from sphere_scene import views

from reflest_ros.scan_trends import RecentCounts


@pytest.fixture(scope="module")
def scanning(start, settings_file):
    """A node with little memory for its fine voxels, which hears of silence early."""
    node = start(
        "reflest_ros.estimator",
        "--ros-args",
        "--params-file",
        settings_file,
        "-p",
        "fusion.memory_budget_mb:=16.0",
        "-p",
        "fusion.voxel_size:=0.002",
        "-p",
        "input.silence:=1.0",
    )
    node.wait_for_line("listening to", 600.0)
    return node


@pytest.fixture(scope="module")
def scanned(scanning, peer):
    """The capture was sent; the second half of it was exposed for longer."""
    capture = list(views(24))
    for number, view in enumerate(capture):
        gain = 0.4 if number < 12 else 0.9
        darkened = np.clip(view.rgb * gain, 0, 255).astype(np.uint8)
        for topic, message in messages_of(dataclasses.replace(view, rgb=darkened)):
            peer.publish(topic, message)
    for role in ("rgb", "depth", "camera_info", "pose"):
        key = f"rate {role} (Hz)"
        peer.wait_until(lambda key=key: float(peer.diagnostics.get(key, 0.0)) > 0.0, role)
    peer.wait_for_count("frames fused", len(capture))
    peer.wait_for_count("estimates", 1)
    return capture


def test_counts_and_ratio(scanned, peer):
    assert float(peer.diagnostics["matched ratio"]) == 1.0
    assert peer.diagnostics["messages rgb"] == str(len(scanned))
    assert float(peer.diagnostics["last estimate's age (s)"]) >= 0.0
    assert float(peer.diagnostics["last estimate's latency (s)"]) > 0.0


def test_a_store_at_its_budget_is_said_and_keeps_to_it(scanning, scanned, peer):
    warning = scanning.wait_for_line(r"\(cause: store_full; logged once\)", SOON)
    assert "fusion.memory_budget_mb" in warning
    assert "16 MB" in warning
    peer.wait_until(lambda: "budget of 16 MB" in peer.state, "it does not say so", SOON)
    assert peer.level == DiagnosticStatus.WARN
    assert 0.8 < float(peer.diagnostics["store in use"]) <= 1.0
    assert float(peer.diagnostics["store (MB)"]) <= float(peer.diagnostics["store budget (MB)"])
    assert len(scanning.lines_with("store_full")) == 1


def test_a_longer_exposure_is_said_in_stops(scanning, scanned, peer):
    warning = scanning.wait_for_line(r"\(cause: exposure_drift; logged once\)", SOON)
    assert "brighter" in warning
    # 8-bit values times 0.9 / 0.4 are about (0.9 / 0.4) ** 2.2 in linear light.
    drift = float(peer.diagnostics["exposure drift (stops)"])
    assert drift == pytest.approx(2.2 * math.log2(0.9 / 0.4), abs=1.0)
    assert "are seen in the background and corrected" in warning
    correction = float(peer.diagnostics["exposure correction (stops)"])
    assert correction == pytest.approx(-2.2 * math.log2(0.9 / 0.4), abs=0.4)


def test_the_light_that_was_seen_is_reported(scanned, peer):
    assert 0.0 < float(peer.diagnostics["light seen"]) < 1.0


def test_silence_names_the_last_stamp_and_the_publishers_policies(scanning, scanned, peer):
    last_stamp = f"{scanned[-1].stamp_ns / 1e9:.3f} s"
    warning = scanning.wait_for_line(f"no message for 1 s on {RGB} .*last stamp: {last_stamp}")
    assert "/peer, reliable, volatile" in warning
    peer.wait_until(lambda: "no message for 1 s" in peer.state, "it does not say so", SOON)


def test_recent_counts_forget_what_is_older_than_the_window():
    counts = RecentCounts(5.0)
    assert counts.rate("a") == 0.0
    for second in range(10):
        counts.sample(float(second), {"a": 30 * second, "b": 7})
    assert counts.rate("a") == pytest.approx(30.0)
    assert counts.increase("a") == 150
    assert counts.increase("b") == counts.increase("unknown") == 0
    counts.sample(10.0, {"a": 270, "b": 7, "c": 2})
    assert counts.increase("c") == 2


def test_two_nodes_of_one_name_are_named(start):
    arguments = ("--ros-args", "-r", "__ns:=/twins", "-p", "lifecycle.autostart:=false")
    first = start("reflest_ros.estimator", *arguments)
    first.wait_for_line("waiting to be configured")
    assert not first.lines_with("another node is named")
    second = start("reflest_ros.estimator", *arguments)
    for node in (first, second):
        assert "/twins/reflest_estimator" in node.wait_for_line("another node is named")
