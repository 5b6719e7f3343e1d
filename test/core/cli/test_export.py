# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The subcommand from file to file."""

import json

import cv2
import pytest

from reflest_core.cli.main import main
from reflest_core.estimation.estimate import SCHEMA_VERSION
from test.core.export.estimates import GLOSSY_RED

SPHERE = ("--sphere", "--format")


@pytest.fixture
def estimate_file(tmp_path):
    path = tmp_path / "replay.json"
    path.write_text(json.dumps({"schema_version": SCHEMA_VERSION, "final": GLOSSY_RED.to_json()}))
    return path


def test_an_estimate_becomes_a_material(estimate_file, tmp_path, capsys):
    out = tmp_path / "material.gltf"
    assert main(["export", str(estimate_file), *SPHERE, "gltf", "--out", str(out)]) == 0
    assert json.loads(out.read_text())["materials"][0]["name"] == "reflest_material"
    assert capsys.readouterr().out == f"wrote {out}\n"


def test_a_users_mistake_is_one_line(tmp_path, capsys):
    nothing = str(tmp_path / "nothing.json")
    code = main(
        ["export", nothing, "--sphere", "--format", "usd", "--out", str(tmp_path / "a.usda")]
    )
    assert code == 2
    assert capsys.readouterr().err.startswith(f"reflest: error: {nothing} does not exist")


def test_a_saved_scan_becomes_an_environment_that_lights_the_material(
    estimate_file, weights, bag, tmp_path, capsys
):
    scan, light = tmp_path / "scan", tmp_path / "light.hdr"
    replay = ["replay", str(bag), "--weights", str(weights), "--voxel-size", "0.01"]
    replay += ["--roi-sphere", "0", "0", "0", "0.16"]
    replay += ["--save-scan", str(scan), "--environment", str(light)]
    assert main(replay) == 0
    assert capsys.readouterr().out.endswith(f"wrote {scan}\nwrote {light}\n")
    assert main(["replay", str(scan)]) == 2
    assert f"`reflest view {scan}` shows it" in capsys.readouterr().err
    again = tmp_path / "again.hdr"
    assert main(["export", str(scan), "--format", "hdr", "--out", str(again)]) == 0
    assert again.read_bytes() == light.read_bytes()
    picture = cv2.imread(str(light), cv2.IMREAD_UNCHANGED)
    assert picture.shape == (128, 256, 3)
    assert picture.max() > 0.0

    scene = tmp_path / "scene.xml"
    lit = ["--format", "mitsuba-stock", "--environment", str(light), "--out", str(scene)]
    assert main(["export", str(estimate_file), "--sphere", *lit]) == 0
    assert 'value="light.hdr"' in scene.read_text()


def test_the_light_is_not_lit(tmp_path, capsys):
    light = ["--out", str(tmp_path / "a.hdr"), "--environment", str(tmp_path / "b.hdr")]
    (tmp_path / "scan").touch()
    (tmp_path / "b.hdr").touch()
    assert main(["export", str(tmp_path / "scan"), "--format", "hdr", *light]) == 2
    assert "hdr is the light itself" in capsys.readouterr().err


def test_a_replay_refuses_a_light_of_no_format_before_it_begins(bag, tmp_path, capsys):
    assert main(["replay", str(bag), "--environment", str(tmp_path / "light.png")]) == 2
    assert "must end in .hdr or .exr" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--format", "hdr", "--out", "x.glb"], "must end in .hdr for the format hdr"),
        (["--format", "hdr", "--out", "x.hdr", "--faces", "5"], "--faces is for a surface"),
        (["--format", "exr", "--out", "x.exr", "--texture", "64"], "--texture is for a surface"),
        (["--format", "hdr", "--out", "x.hdr", "--watertight"], "--watertight is for a surface"),
        (["--format", "hdr", "--out", "x.hdr", "--sphere"], "--sphere is for a surface"),
        (["--format", "glb", "--out", "x.glb", "--sphere", "--faces", "9"], "leave it or --sphere"),
        (["--format", "ply", "--out", "x.ply", "--sphere", "--environment", "room.hdr"], "no env"),
        (["--format", "glb", "--out", "x.glb", "--faces", "3"], "faces is 3"),
        (
            ["--format", "usd", "--out", "room.usda", "--known-light", "room_environment.exr"],
            "room_environment.exr would overwrite room_environment.exr",
        ),
    ],
)
def test_options_are_checked_before_the_scan_is_read(
    tmp_path, monkeypatch, capsys, arguments, sentence
):
    monkeypatch.chdir(tmp_path)
    for name in ("scan", "room.hdr", "room_environment.exr"):
        (tmp_path / name).write_bytes(b"neither scan nor light")
    assert main(["export", "scan", *arguments]) == 2
    assert sentence in capsys.readouterr().err
