# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The subcommand from file to file."""

import json

import pytest

from reflest_core.cli.main import main
from reflest_core.estimation.estimate import SCHEMA_VERSION
from test.core.export.estimates import GLOSSY_RED


@pytest.fixture
def estimate_file(tmp_path):
    path = tmp_path / "replay.json"
    path.write_text(json.dumps({"schema_version": SCHEMA_VERSION, "final": GLOSSY_RED.to_json()}))
    return path


def test_an_estimate_becomes_a_material(estimate_file, tmp_path, capsys):
    out = tmp_path / "material.gltf"
    assert main(["export", str(estimate_file), "--format", "gltf", "--out", str(out)]) == 0
    assert json.loads(out.read_text())["materials"][0]["name"] == "reflest"
    assert capsys.readouterr().out == f"wrote {out}\n"


def test_a_users_mistake_is_one_line(tmp_path, capsys):
    nothing = str(tmp_path / "nothing.json")
    code = main(["export", nothing, "--format", "usd", "--out", str(tmp_path / "a.usda")])
    assert code == 2
    assert capsys.readouterr().err.startswith(f"reflest: error: cannot read {nothing}")
