# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The data card's numbers and pictures from a small set."""

import dataclasses

import cv2
import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.cli.main import main
from reflest_core.synbrdf.card.contact_sheet import TILE, contact_sheet
from reflest_core.synbrdf.card.image_strip import TILE as STRIP_TILE
from reflest_core.synbrdf.card.image_strip import image_strip
from reflest_core.synbrdf.card.numbers import clipping, table
from reflest_core.synbrdf.card.summary import SceneSummary
from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.realism.settings import Realism
from reflest_core.synbrdf.scenes.scene_file import shard_bytes
from reflest_core.synbrdf.scenes.splits import Split
from test.synbrdf.realism.sparse_scenes import ball_scene


def test_a_summary_is_of_the_scene():
    scene = ball_scene()
    colours = scene.surface.colours.copy()
    colours[: len(colours) // 4, 1] = 255
    surface = dataclasses.replace(scene.surface, colours=colours)
    summary = SceneSummary.of(dataclasses.replace(scene, surface=surface))
    assert summary.clipped == pytest.approx(0.25, abs=0.01)
    assert summary.diameter == pytest.approx(0.2)
    assert summary.distance == pytest.approx(np.hypot(1.0, 0.3))
    assert summary.luminance == pytest.approx(0.2126 * 0.9 + 0.7152 * 0.5 + 0.0722 * 0.3, rel=1e-4)
    assert summary.observations == pytest.approx(len(colours) / 200)
    assert "| train (1 scenes) | rho_s | 0.000 |" in table([summary])
    assert "25 % (smooth, ball)" in clipping([summary])


def test_the_command_writes_histograms_and_numbers(tmp_path, capsys):
    data, out = tmp_path / "set", tmp_path / "card"
    assert main(["synbrdf", "card", "--out", str(out), "--data", str(tmp_path)]) == 2
    assert "manifest.json" in capsys.readouterr().err
    data.mkdir()
    (data / "manifest.json").write_text("{}")
    (data / "train-00000.safetensors").write_bytes(
        shard_bytes([ball_scene(seed=k) for k in range(3)])
    )
    assert main(["synbrdf", "card", "--out", str(out), "--data", str(data)]) == 0
    assert "train (3 scenes)" in (out / "numbers.md").read_text()
    for name in ("materials.png", "captures.png"):
        assert cv2.imread(str(out / name)).std() > 10


def test_a_contact_sheet_shows_scenes_and_depth():
    generation = Generation(3, {"train": 4, "validation": 2, "unseen": 2}, views=4)
    sheet = contact_sheet(generation, Split.TRAIN, 2, 2, samples=4)
    assert sheet.shape == (2 * TILE[1], 2 * TILE[0], 3)
    inset = sheet[: int(TILE[1] * 0.4), : int(TILE[0] * 0.4)]
    # Grey: depth; and black where there is none.
    assert (inset == inset[..., :1]).all()
    assert inset.min() == 0
    assert inset.max() > 100
    assert sheet[TILE[1] :].std() > 10


def test_a_strip_shows_clean_and_degraded_images():
    generation = Generation(
        3, {"train": 4, "validation": 2, "unseen": 2}, views=4, realism=Realism()
    )
    strip = image_strip(generation, Split.TRAIN, [1], view=0, samples=4)
    width, height = STRIP_TILE
    assert strip.shape == (height, 7 * width, 3)
    colour, dark, depth, normals, mask, real, measured = np.split(strip.astype(int), 7, axis=1)
    assert dark.mean() < colour.mean()
    assert set(np.unique(mask[..., 0])) >= {0, 255}
    assert (depth[mask[..., 0] == 0] == 0).all()
    # Zero off the object, where no normal is.
    assert np.abs(normals[mask[..., 0] == 0] - 128).max() <= 1
    assert np.abs(real - colour).max() > 3
    assert np.abs(measured - depth).max() > 3
