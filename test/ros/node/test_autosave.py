# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A node that is killed in mid-scan continues the scan when it is started again."""

from __future__ import annotations

import dataclasses
import math
import os
import shutil
import signal

import pytest
from ros_peer import RosPeer
from sphere_messages import messages_of
from sphere_scene import views
from std_srvs.srv import Trigger

from reflest_core.fusion.scan import Scan
from reflest_core.fusion.scan_file import read_scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_ros.outputs.estimate_message import estimate_from_message
from reflest_ros.srv import Estimate


@pytest.fixture
def started(start, settings_file, domain_id):
    """Start a node that saves to a path. Each gets a peer that has never met a killed one."""
    nodes, peers = [], []

    def one(path):
        node = start(
            "reflest_ros.estimator",
            "--ros-args",
            "--params-file",
            settings_file,
            "-p",
            f"autosave.path:={path}",
            "-p",
            "autosave.period:=0.1",
        )
        node.wait_for_line("listening to", 600.0)
        nodes.append(node)
        peers.append(RosPeer(domain_id))
        return node, peers[-1]

    yield one
    for peer in peers:
        peer.close()
    for node in nodes:
        node.end()


def send(peer, some):
    for view in some:
        for topic, message in messages_of(view):
            peer.publish(topic, message)


def saved_frames(path):
    return read_scan(path)[0]["frame_number"] if path.exists() else None


def estimate(peer):
    response = peer.call(Estimate, "estimate")
    assert response.success, response.message
    return dataclasses.replace(estimate_from_message(response.estimate), latency=math.nan).to_json()


def test_kill_and_resume(started, tmp_path):
    path = tmp_path / "scan.reflest"
    first, second = list(views(8))[:5], list(views(8))[5:]

    node, peer = started(path)
    send(peer, first)
    peer.wait_until(lambda: saved_frames(path) == 5, "the scan was not saved")
    before = estimate(peer)
    node.interrupt(signal.SIGKILL)
    assert node.exit_code() == -signal.SIGKILL
    (tmp_path / ".scan.reflest.1.partial").write_bytes(b"what a kill in mid-write leaves")

    # Started again, it has the scan, and goes on.
    node, peer = started(path)
    assert "5 views" in node.wait_for_line("resumed the scan")
    assert estimate(peer) == before
    assert {one.name for one in tmp_path.iterdir()} == {path.name, ".scan.reflest.lock"}
    send(peer, second)
    peer.wait_until(lambda: saved_frames(path) == 8, "the scan did not go on")

    # What a reset forgot stays forgotten, also where the node ends at once.
    assert peer.call(Trigger, "reset").success
    node.interrupt(signal.SIGTERM)
    assert node.exit_code() == 0, node.output
    assert saved_frames(path) == 0


def test_a_damaged_scan_is_set_aside(started, tmp_path):
    path = tmp_path / "scan.reflest"
    Scan(FusionSettings(memory_budget_mb=16.0), RegionSettings()).save(path)
    damaged = path.read_bytes()[:-4000]
    path.write_bytes(damaged)
    node, _ = started(path)
    assert "a new scan begins" in node.wait_for_line("damaged")
    (aside,) = tmp_path.glob("scan.reflest.damaged-*")
    assert aside.read_bytes() == damaged


@pytest.mark.parametrize("kind", ["folder", "other file", "unreadable", "fifo"])
def test_what_is_no_scan_is_refused_and_stays(start, settings_file, tmp_path, kind):
    path = tmp_path / "mine"
    if kind == "folder":
        path.mkdir()
        (path / "precious").write_text("precious")
    elif kind == "fifo":
        os.mkfifo(path)
    else:
        path.write_text("precious")
        path.chmod(0o000 if kind == "unreadable" else 0o640)
    before = path.stat()
    arguments = ("--params-file", settings_file, "-p", f"autosave.path:={path}")
    node = start("reflest_ros.estimator", "--ros-args", *arguments)
    assert node.exit_code(600.0) == 2, node.output
    assert str(path) in node.output
    assert "Traceback" not in node.output
    after = path.stat()
    assert (after.st_ino, after.st_mode, after.st_mtime) == (
        before.st_ino,
        before.st_mode,
        before.st_mtime,
    )


def test_two_nodes_do_not_share_a_file(started, start, settings_file, tmp_path):
    path = tmp_path / "scan.reflest"
    started(path)
    arguments = ("--params-file", settings_file, "-p", f"autosave.path:={path}")
    second = start("reflest_ros.estimator", "--ros-args", *arguments, "-r", "__node:=second")
    assert second.exit_code(600.0) == 2, second.output
    assert "used by another node" in second.output


def test_a_folder_that_goes_is_said_and_the_scan_goes_on(started, tmp_path):
    folder = tmp_path / "folder"
    folder.mkdir()
    node, peer = started(folder / "scan.reflest")
    shutil.rmtree(folder)
    send(peer, list(views(8))[:2])
    assert str(folder) in node.wait_for_line("continues without autosave")
    peer.wait_until(lambda: "autosave fails" in peer.state, "diagnostics do not say so")
    assert estimate(peer)["voxel_count"] > 0
