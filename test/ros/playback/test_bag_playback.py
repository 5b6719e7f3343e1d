# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A bag played over DDS, against ``reflest replay`` of the same bag; the services on the result.

The tests of this module share one node and continue each other's scan.
"""

from __future__ import annotations

import dataclasses
import json
import math
import statistics
import subprocess
import sys
import time

import pytest
from own_process import ROOT
from std_srvs.srv import Trigger

from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_ros.outputs.estimate_message import estimate_from_message
from reflest_ros.srv import Estimate, LoadScan, SaveScan

FRAMES = 24
MOST_LATENCY = 5.0
"""Times the work itself: it shares the processors with the player and with this process."""


@pytest.fixture(scope="module")
def replayed(sphere_bag, settings_file, tmp_path_factory):
    """The estimates of ``reflest replay``: every keyframe's and the final one."""
    out = tmp_path_factory.mktemp("replay") / "estimates.json"
    subprocess.run(
        [
            sys.executable,
            "-m",
            "reflest_core.cli.main",
            "replay",
            sphere_bag,
            "--config",
            settings_file,
            "--json",
            out,
        ],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    )
    return json.loads(out.read_text())


@pytest.fixture(scope="module")
def played(node, peer, start, sphere_bag, replayed):
    """The estimates that arrived while the bag was played to the node, the last one among them."""
    player = start("reflest_ros.bag_player", sphere_bag, "--rate", "0.25")
    assert player.exit_code() == 0, player.output
    peer.wait_for_count("frames fused", FRAMES)
    last_stamp_ns = replayed["estimates"][-1]["header"]["stamp_ns"]
    peer.wait_until(
        lambda: bool(peer.estimates) and peer.estimates[-1].stamp_ns == last_stamp_ns,
        "the last keyframe's estimate did not arrive",
    )
    return list(peer.estimates)


def without_latency(estimate):
    return dataclasses.replace(estimate, latency=float("nan")).to_json()


def test_last_keyframe_is_estimated_as_by_replay(played, replayed):
    assert without_latency(played[-1]) == replayed["estimates"][-1]


def test_every_published_estimate_is_one_of_replay(played, replayed):
    by_stamp = {one["header"]["stamp_ns"]: one for one in replayed["estimates"]}
    for estimate in played:
        assert without_latency(estimate) == by_stamp[estimate.stamp_ns]


def test_latency_is_a_few_times_what_the_work_takes_offline(played, sphere_bag, settings_file):
    """Fusion and estimate of the same keyframes on the same machine are the measure."""
    scanner = Pipeline(ReflestSettings.from_yaml(settings_file))
    taken = []
    for frame in open_capture(sphere_bag):
        started = time.perf_counter()
        keyframe = scanner.fuse(frame).keyframe
        if keyframe is not None:
            scanner.estimate(keyframe)
            taken.append(time.perf_counter() - started)
    latencies = [estimate.latency for estimate in played]
    assert min(latencies) > 0.0
    assert statistics.median(latencies) < MOST_LATENCY * statistics.median(taken)


def test_nothing_was_lost_or_refused(played, peer):
    assert peer.count("frames fused") == peer.count("messages rgb") == FRAMES
    assert not [key for key in peer.diagnostics if key.startswith("refused")]


def test_estimate_now_is_the_final_one_of_replay_and_is_published(played, replayed, peer):
    response = peer.call(Estimate, "estimate")
    assert response.success, response.message
    estimate = estimate_from_message(response.estimate)
    assert without_latency(estimate) == replayed["final"]
    published = estimate.to_json()
    peer.wait_until(lambda: peer.estimates[-1].to_json() == published, "it was not published")


def test_reset_empties_and_a_saved_scan_comes_back(played, peer, tmp_path):
    before = estimate_from_message(peer.call(Estimate, "estimate").estimate)
    path = tmp_path / "scan.reflest"
    saved = peer.call(SaveScan, "save", path=str(path))
    assert saved.success, saved.message
    assert path.stat().st_size > 0

    assert peer.call(Trigger, "reset").success
    peer.wait_until(lambda: peer.diagnostics["voxels"] == "0", "voxels are left")
    assert peer.diagnostics["observations"] == peer.diagnostics["views"] == "0"
    nothing = peer.call(Estimate, "estimate")
    assert not nothing.success
    assert "0 voxels" in nothing.message

    loaded = peer.call(LoadScan, "load", path=str(path))
    assert loaded.success, loaded.message
    after = estimate_from_message(peer.call(Estimate, "estimate").estimate)
    # The agreement of depth images is measured again with the next frames.
    before = dataclasses.replace(before, depth_agreement=math.nan)
    assert without_latency(after) == without_latency(before)


def test_loading_what_is_no_scan_says_so_and_keeps_the_scan(played, peer, tmp_path):
    voxels = estimate_from_message(peer.call(Estimate, "estimate").estimate).voxel_count
    path = tmp_path / "not_a_scan.txt"
    path.write_text("not a scan")
    response = peer.call(LoadScan, "load", path=str(path))
    assert not response.success
    assert str(path) in response.message
    assert "Traceback" not in response.message
    kept = peer.call(Estimate, "estimate").estimate
    assert kept.voxel_count == voxels


@pytest.mark.parametrize(("kind", "name"), [(SaveScan, "save"), (LoadScan, "load")])
def test_a_file_service_needs_a_path(node, peer, kind, name):
    response = peer.call(kind, name, path="")
    assert not response.success
    assert "path is empty" in response.message


def test_saving_where_nothing_can_be_written_says_so(node, peer):
    response = peer.call(SaveScan, "save", path="/no/such/folder/scan.reflest")
    assert not response.success
    assert "/no/such/folder" in response.message
