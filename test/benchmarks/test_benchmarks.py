# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One tiny run of everything: whether all is measured and published, not how fast it is."""

from __future__ import annotations

import json
import re
import socket

import domain_coordinator
import pytest

from benchmarks.measurements.materials import SCRATCH, STEADY, STEPS
from benchmarks.measurements.stages import (
    ASSEMBLE,
    CAPTURE_STAGES,
    EAGER,
    ESTIMATE,
    ESTIMATION_STAGES,
    FEATURES,
    FRAME,
    FROM_STORE,
    FUSE,
    FUSE_DEPTH,
    FUSE_KNOWN,
    FUSE_NEW,
    FUSE_REDUNDANT,
    FUSION_STAGES,
    NETWORK,
    PUBLISH,
    SHIPPED_KIND,
)
from benchmarks.measuring.machine import ROOT
from benchmarks.plan import TINY
from benchmarks.report.page import BEGIN, END, GuideDamaged, write_page
from benchmarks.report.targets import targets
from benchmarks.run import run
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.models.registry import network_of_model, shipped_models

pytestmark = pytest.mark.timeout(1800)
"""The run takes half a minute of processor time, on a crowded machine much longer."""

GUIDE = f"# Guide\n\nbefore\n\n{BEGIN}\nold figures\n{END}\n\nafter\n"
KINDS = (FUSE_NEW, FUSE_KNOWN, FUSE_DEPTH, FUSE_REDUNDANT)
LIVE_FRAMES = round(TINY.live_seconds * TINY.rate)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch, domain_coordinator.domain_id() as domain:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        return run(TINY, tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="module")
def docs(results, tmp_path_factory):
    folder = tmp_path_factory.mktemp("docs")
    (folder / "performance.md").write_text(GUIDE)
    write_page(results, folder)
    return folder


@pytest.fixture(scope="module")
def page(docs):
    return (docs / "results" / "performance.md").read_text()


def names(timings):
    return {one["name"] for one in timings}


def test_every_stage_of_the_live_path_is_timed(results):
    stages = results["frame_path"]["1"]["stages"]
    expected = {one.name for one in (*CAPTURE_STAGES, *FUSION_STAGES, *ESTIMATION_STAGES)}
    network = network_of_model(EstimationSettings().model).name
    expected -= {feature for kind, feature in FEATURES.items() if kind != network}
    assert names(stages) == expected | {
        ASSEMBLE,
        FUSE,
        FRAME,
        ESTIMATE,
        PUBLISH,
        *(names(stages) & set(KINDS)),
    }
    assert all(0.0 < one["p50_ms"] <= one["p95_ms"] <= one["p99_ms"] for one in stages)


def test_stages_that_run_for_every_frame_are_timed_for_every_frame(results):
    counts = {one["name"]: one["count"] for one in results["frame_path"]["1"]["stages"]}
    for name in ("match", "decode", ASSEMBLE, FUSE, FRAME):
        assert counts[name] == TINY.frame_path, name
    assert counts[FUSE_NEW] > 0
    assert sum(counts.get(kind, 0) for kind in KINDS) == TINY.frame_path


def test_memory_is_noted_stage_by_stage(results):
    memory = {one["name"]: one["memory_mb"] for one in results["frame_path"]["1"]["stages"]}
    assert memory["TSDF"] is not None
    assert memory["network"] is not None
    assert results["frame_path"]["1"]["peak_mb"] > 0.0


def test_models_are_timed_stage_by_stage_and_against_eager_torch(results):
    models = results["estimation"]["1"]["models"]
    assert set(models) == set(shipped_models())
    for model, kinds in models.items():
        feature = FEATURES[network_of_model(model).name]
        stages = {"snapshot", "voxel choice", feature, NETWORK, "coverage", ESTIMATE, FROM_STORE}
        assert names(kinds[SHIPPED_KIND]) == stages
        assert names(kinds[EAGER]) == {NETWORK}
        assert all(one["count"] == TINY.estimates for one in kinds[EAGER])


def test_open3d_fuses_the_same_frames_with_and_without_colour(results):
    compared = results["against_open3d"]["1"]
    assert set(compared) == {"colour", "depth only"}
    for one in compared.values():
        assert one["frames"] == TINY.peer_frames
        assert one["p50"]["ratio"] == pytest.approx(one["p50"]["fuse_ms"] / one["p50"]["open3d_ms"])


def test_growth_covers_every_size_of_the_plan(results):
    fusion, estimates = results["growth_of_fusion"], results["growth_of_estimates"]
    assert [one["voxel_size_mm"] for one in fusion["voxel_size"]] == list(TINY.voxel_sizes)
    sizes = [(one["width"], one["height"]) for one in fusion["resolution"]]
    assert sizes == list(TINY.resolutions)
    voxels = [one["voxels"] for one in fusion["voxel_size"]]
    assert voxels == sorted(voxels), "smaller voxels must be more"
    for one, wanted in zip(estimates["store"], TINY.store_voxels, strict=True):
        assert 0.7 * wanted < one["voxels"] < 1.3 * wanted
    assert [one["views"] for one in estimates["views"]] == list(TINY.view_counts)


def test_the_live_run_accounts_for_every_message(results):
    live = results["live"]
    assert live["messages_sent"] == 4 * LIVE_FRAMES
    assert (
        live["messages_received"] + live["messages_lost"]["on the way (DDS)"]
        == (live["messages_sent"])
    )
    kept = live["frames_fused"] + live["frames_redundant"]
    assert kept + live["frames_lost"] == live["frames_played"] == LIVE_FRAMES
    assert kept > 0
    assert live["estimates"] == live["latency"]["count"] > 0
    assert live["slowest"][0]["latency_ms"] >= live["latency"]["p99_ms"]


def test_materials_are_timed_from_scratch_and_from_moment_to_moment(results):
    materials = results["materials"]
    counts = {one["name"]: one["count"] for one in materials["timings"]}
    assert counts == {SCRATCH: 2, STEADY: STEPS}
    assert materials["materials"] >= 1
    assert materials["voxels"] > 1000
    named = [one.what for one in targets(results) if one.what.startswith("materials of")]
    assert len(named) == 2


def test_memory_of_a_full_scan_is_measured(results):
    memory = results["memory"]
    assert memory["observations"] > memory["voxels"] > 0
    assert memory["between_frames_mb"] > 0.0


def test_start_up_and_replay_are_measured(results):
    phases = {one["name"]: one["p50_ms"] for one in results["start_up"]["phases"]}
    parts = ("interpreter", "import", "warm up", "first frame", "first estimate")
    assert sum(phases[one] for one in parts) <= phases["process start to first estimate"]
    assert results["replay"]["frames"]["seen"] == LIVE_FRAMES
    assert results["replay"]["estimates"] > 0


def test_the_page_has_every_section_and_the_plots_that_it_shows(docs, page):
    for title in (
        "Targets",
        "Stages",
        "Open3D",
        "Estimates",
        "Growth",
        "node",
        "Memory",
        "Start-up",
    ):
        assert re.search(f"^## .*{title}", page, re.MULTILINE), title
    shown = re.findall(r"!\[[^]]*\]\(\.\./([^)]+)\)", page)
    assert len(shown) == 2
    for plot in shown:
        assert (docs / plot).read_bytes().startswith(b"\x89PNG")


def test_the_json_is_what_was_measured(docs, results):
    assert json.loads((docs / "results" / "performance.json").read_text()) == json.loads(
        json.dumps(results)
    )


def test_nothing_published_names_the_machine_or_its_folders(docs, page, tmp_path):
    published = page + (docs / "results" / "performance.json").read_text()
    for private in (str(ROOT), str(tmp_path.parent), "/home", "/tmp"):
        assert private not in published
    # A machine may have the name of a word that stands in every such page.
    in_every = "".join(path.read_text() for path in (ROOT / "docs/results").glob("performance.*"))
    assert socket.gethostname() not in words(published) - words(in_every)


def words(text):
    return set(re.findall(r"[\w.-]+", text))


def test_the_guide_gets_the_figures_between_its_marks_alone(docs):
    guide = (docs / "performance.md").read_text()
    assert guide.startswith(f"# Guide\n\nbefore\n\n{BEGIN}")
    assert guide.endswith(f"{END}\n\nafter\n")
    assert "old figures" not in guide
    assert "whole frame against Open3D" in guide


def test_a_guide_without_its_marks_is_left_alone(results, tmp_path):
    guide = tmp_path / "performance.md"
    guide.write_text("# Guide\n")
    with pytest.raises(GuideDamaged, match="restore them"):
        write_page(results, tmp_path)
    assert guide.read_text() == "# Guide\n"
