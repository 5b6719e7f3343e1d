# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is refused, in one sentence, and that no half file is left."""

import json
import math
from pathlib import Path

import pytest

from reflest_core.estimation.estimate import READABLE_VERSIONS, SCHEMA_VERSION, BrdfEstimate
from reflest_core.export.errors import ExportError
from reflest_core.export.estimate_file import estimate_from_record, read_estimate
from reflest_core.export.exporter import FORMATS, asset_name, checked_format, export_estimate
from reflest_core.whole_file import OutputError
from test.core.export.estimates import GLOSSY_RED, glossy_red


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_gives_the_same_bytes_twice(name, tmp_path):
    contents = []
    for stem in ("a", "b"):
        folder = tmp_path / stem
        folder.mkdir()
        path = folder / f"material{FORMATS[name].suffixes[0]}"
        export_estimate(GLOSSY_RED, name, path)
        contents.append({one.name: one.read_bytes() for one in folder.iterdir()})
    assert contents[0] == contents[1]
    assert path.name in contents[0]


def test_an_unknown_format_names_the_known_ones(tmp_path):
    with pytest.raises(ExportError, match="'fbx' is no export format; known are glb, gltf, usd"):
        export_estimate(GLOSSY_RED, "fbx", tmp_path / "a.fbx")


def test_a_suffix_of_another_format_is_refused(tmp_path):
    with pytest.raises(ExportError, match=r"must end in \.usda or \.usdc or"):
        export_estimate(GLOSSY_RED, "usd", tmp_path / "a.glb")
    with pytest.raises(ExportError, match=r"ends in no known suffix; known are \.glb"):
        checked_format(tmp_path / "a.docx")


@pytest.mark.parametrize(
    ("name", "expected"),
    [("table", "table"), ("my table-2", "my_table_2"), ("7up", "scan_7up"), ("äö", "scan")],
)
def test_names_in_files_are_letters_digits_and_underscores(name, expected):
    assert asset_name(Path(f"{name}.glb")) == expected


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"rho_d": (math.nan, 0.1, 0.1)}, "rho_d"),
        ({"rho_d": (1.2, 0.1, 0.1)}, "rho_d"),
        ({"rho_s": math.nan}, "rho_s"),
        ({"rho_s": -0.1}, "rho_s"),
        ({"alpha": 0.0}, "alpha"),
        ({"alpha": math.inf}, "alpha"),
        ({"ward_variant": "phong"}, "ward_variant"),
    ],
)
def test_what_is_not_physical_is_refused_by_name(changes, name, tmp_path):
    path = tmp_path / "a.gltf"
    path.write_text("what was there")
    with pytest.raises(ExportError, match=f"the estimate's {name} is "):
        export_estimate(glossy_red(**changes), "gltf", path)
    assert path.read_text() == "what was there"


def test_a_folder_that_is_missing_is_named(tmp_path):
    with pytest.raises(OutputError, match=r"cannot write .*nowhere"):
        export_estimate(GLOSSY_RED, "gltf", tmp_path / "nowhere" / "a.gltf")


def test_an_estimate_comes_back_from_its_record():
    back = estimate_from_record(json.loads(json.dumps(GLOSSY_RED.to_json())))
    assert isinstance(back, BrdfEstimate)
    assert back.to_json() == GLOSSY_RED.to_json()
    assert math.isnan(back.alpha_stddev)


@pytest.mark.parametrize("version", READABLE_VERSIONS)
def test_the_final_estimate_of_a_replay_is_read(tmp_path, version):
    path = tmp_path / "replay.json"
    record = {"schema_version": version, "estimates": [], "final": GLOSSY_RED.to_json()}
    path.write_text(json.dumps(record))
    assert read_estimate(path).rho_d == GLOSSY_RED.rho_d


@pytest.mark.parametrize(
    ("version", "number", "status"),
    [(1, 0, "OK"), (2, 0, "OK"), (2, 3, "LOW_LIGHT"), (3, 0, "UNKNOWN"), (3, 8, "OK")],
)
def test_a_status_keeps_the_meaning_of_its_version(tmp_path, version, number, status):
    record = {**GLOSSY_RED.to_json(), "schema_version": version, "status": number}
    if version < 3:
        del record["depth_agreement"]
    path = tmp_path / "replay.json"
    path.write_text(json.dumps(record))
    assert read_estimate(path).status.name == status


def test_a_single_estimate_is_read(tmp_path):
    path = tmp_path / "estimate.json"
    path.write_text(json.dumps(GLOSSY_RED.to_json()))
    assert read_estimate(path).stamp_ns == GLOSSY_RED.stamp_ns


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("{", "is not JSON"),
        ("[]", "holds no estimate"),
        ("{}", "has no schema_version, so it is not what `reflest replay"),
        ('{"schema_version": 9}', "has schema_version 9, and this reflest reads 1, 2 and 3"),
        ('{"schema_version": V, "final": null, "no_estimate": "3 voxels"}', "estimate: 3 voxels"),
        ('{"schema_version": V, "final": {"header": {}}}', "damaged estimate"),
        ('{"schema_version": V, "final": []}', "damaged estimate"),
    ],
)
def test_a_bad_file_is_refused_in_one_sentence(text, sentence, tmp_path):
    path = tmp_path / "estimate.json"
    path.write_text(text.replace("V,", f"{SCHEMA_VERSION},"))
    with pytest.raises(ExportError, match=sentence):
        read_estimate(path)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(ExportError, match=r"cannot read .*No such file"):
        read_estimate(tmp_path / "nothing.json")
