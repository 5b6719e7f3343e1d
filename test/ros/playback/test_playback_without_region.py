# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Without a region the node publishes the material in the middle of the view, as replay does."""

from __future__ import annotations

import dataclasses
import json

import pytest

from reflest_core.cli.main import main
from reflest_core.estimation.estimate import EstimateStatus
from reflest_ros.outputs.estimate_message import estimate_from_message
from reflest_ros.srv import Estimate

FRAMES = 24


@pytest.fixture(scope="module")
def settings_file(settings_file, tmp_path_factory):
    text = settings_file.read_text().replace("voxel_size: 0.01", "voxel_size: 0.006")
    path = tmp_path_factory.mktemp("scene") / "estimator.yaml"
    path.write_text("".join(line for line in text.splitlines(True) if "region:" not in line))
    return path


@pytest.fixture(scope="module")
def replayed(sphere_bag, settings_file, tmp_path_factory):
    out = tmp_path_factory.mktemp("replay") / "estimates.json"
    assert (
        main(["replay", str(sphere_bag), "--config", str(settings_file), "--json", str(out)]) == 0
    )
    return json.loads(out.read_text())


@pytest.fixture(scope="module")
def played(node, peer, start, sphere_bag):
    player = start("reflest_ros.bag_player", sphere_bag, "--rate", "0.25")
    assert player.exit_code() == 0, player.output
    peer.wait_for_count("frames fused", FRAMES)
    answer = peer.call(Estimate, "estimate")
    assert answer.success, answer.message
    return estimate_from_message(answer.estimate)


def without_latency(estimate):
    return dataclasses.replace(estimate, latency=float("nan")).to_json()


def test_the_final_estimate_is_replays_bit_for_bit(played, replayed):
    assert without_latency(played) == replayed["final"]


def test_every_published_estimate_is_one_of_replay(played, replayed, peer):
    known = [*replayed["estimates"], replayed["final"]]
    peer.wait_until(lambda: len(peer.estimates) >= 2, "estimates are missing")
    assert all(without_latency(one) in known for one in peer.estimates)


def test_it_is_a_material_of_the_map_and_not_a_mixture_of_several(replayed):
    final, materials = replayed["final"], replayed["materials"]
    assert final["status"] != EstimateStatus.MIXED_MATERIALS
    (found,) = (one for one in materials if one["id"] == replayed["final_material_id"])
    # The ball, whole, out of the voxels around the middle and out of all.
    assert (
        found["voxel_count"] == final["voxel_count"] < 0.1 * replayed["materials"][0]["voxel_count"]
    )
