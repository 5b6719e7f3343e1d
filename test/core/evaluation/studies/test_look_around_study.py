# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The study of a look around compares the same scans with and without it."""

import json

import pytest

pytest.importorskip("mitsuba")

from reflest_core.cli.main import main
from reflest_core.environment.known_rooms import KnownRooms
from reflest_core.environment.room import Room
from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.networks import EvaluatedNetwork, EvaluationError
from reflest_core.evaluation.page import write_page
from reflest_core.evaluation.record_file import Provenance, write_record
from reflest_core.evaluation.shown_scenes import shown
from reflest_core.evaluation.source_scenes import SourceScenes
from reflest_core.evaluation.statistics.accuracy import accuracy
from reflest_core.evaluation.studies.look_around_study import measure_look_around
from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.lights.environments import rotated
from reflest_core.synbrdf.path_tracing.sparse_scene import SparseRenderer, SparseSettings
from reflest_core.synbrdf.scenes.splits import Split

GENERATION = Generation(3, {"train": 4, "validation": 2, "unseen": 3}, points=60, views=8)


@pytest.fixture(scope="module")
def scenes():
    renderer = SparseRenderer(SparseSettings(points=60, views=8))
    indices = range(3)
    return [renderer.render(GENERATION.scene(Split.UNSEEN, i), GENERATION.seed) for i in indices]


def of_room(sources, scene):
    """Turned as no scene is."""
    return Room.of(scene.environment, rotated(sources.drawn(scene).light.radiance, 1.0))


def test_rooms_of_training_are_those_of_its_split(tmp_path):
    (tmp_path / "manifest.json").write_text(json.dumps(GENERATION.manifest()))
    rooms = SourceScenes(tmp_path, None, None).training_rooms()
    expected = {source.name for source in GENERATION.sources(Split.TRAIN).environments}
    assert {room.name for room in rooms.rooms} == expected


def test_only_the_light_differs(scenes, runs, tmp_path):
    (tmp_path / "manifest.json").write_text(json.dumps(GENERATION.manifest()))
    sources = SourceScenes(tmp_path, None, None)
    lightnet = EvaluatedNetwork(
        "lightnet", "lightnet", "lightnet", runs / "lightnet" / "lightnet.safetensors"
    )
    rooms = KnownRooms([of_room(sources, scene) for scene in scenes], "here")
    found = measure_look_around(lightnet, {"unseen": scenes}, sources.drawn, rooms)
    patterns = {scene.view_pattern for scene in scenes}
    rows = {(row["views"], row["pattern"]): row for row in found["rows"]}
    assert {pattern for _, pattern in rows} == {"all", *patterns}
    whole = rows[100, "all"]
    assert whole["with"]["seen"] > whole["scan"]["seen"]
    assert whole["panorama"]["seen"] == pytest.approx(1.0)
    assert whole["recognised"] == 1.0
    assert whole["rooms"]["seen"] == pytest.approx(1.0)
    estimator = lightnet.estimator()
    samples = [shown(scene) for scene in scenes]
    made = estimate_all(estimator, samples, "scans").ward
    alone = accuracy(made, samples, estimator.predictor.card.statistics)
    assert whole["scan"]["ward"]["overall"] == pytest.approx(alone.ward.overall)
    assert whole["with"]["ward"]["overall"] != whole["scan"]["ward"]["overall"]
    assert whole["panorama"]["ward"]["overall"] != whole["with"]["ward"]["overall"]
    (tmp_path / "out").mkdir()
    provenance = Provenance("reflest evaluate", "0", "none")
    write_record(tmp_path / "out" / "look-around.json", provenance, found)
    page = write_page(tmp_path / "out").read_text()
    for way in ("with", "rooms", "panorama"):
        assert f" {whole[way]['ward']['overall']:.3f} |" in page


def test_a_record_of_an_earlier_version_is_named(tmp_path):
    row = {"split": "unseen", "views": 100, "pattern": "all", "scan": {}, "with": {}}
    provenance = Provenance("reflest evaluate", "0", "none")
    write_record(tmp_path / "look-around.json", provenance, {"frames": 15, "rows": [row]})
    with pytest.raises(EvaluationError, match=r"look-around\.json lacks .*--parts look-around"):
        write_page(tmp_path)


def test_it_needs_the_environments(data, runs, tmp_path, capsys):
    options = ["--out", str(tmp_path), "--runs", str(runs), "--parts", "look-around"]
    assert main(["evaluate", str(data), *options]) == 2
    assert "--environments" in capsys.readouterr().err
