# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Parameter files are read with rcl's rules, as test/ros/node/test_parameter_files.py shows."""

import math

import pytest

from reflest_core.estimation.settings import ReflestSettings
from reflest_core.parameter import ParameterError
from reflest_core.parameter_file import read_parameter_file

SCALARS = {
    "1e-3": 0.001,
    "1e3": 1000.0,
    "0x10": 16,
    "010": 8,
    "-010": -8,
    "1_000": "1_000",
    "+5": 5,
    "5.": 5.0,
    ".5": 0.5,
    "1e400": "1e400",
    "9223372036854775808": 9223372036854775808.0,
    ".inf": math.inf,
    "-.inf": -math.inf,
    "infinity": math.inf,
    "yes": True,
    "off": False,
    "Y": True,
    "tRUE": "tRUE",
    "'on'": "on",
    '"1.0"': "1.0",
    "2024-01-01": "2024-01-01",
    "[1e-3, 2.0]": [0.001, 2.0],
    "[1, 2]": [1, 2],
    "[yes, no]": [True, False],
}


@pytest.fixture
def read(tmp_path):
    def reading(text, node=None):
        path = tmp_path / "p.yaml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_parameter_file(path, node)

    return reading


@pytest.mark.parametrize("text", SCALARS)
def test_a_value_has_the_type_that_rcl_gives_it(read, text):
    value = read(f"/**:\n  ros__parameters:\n    a: {text}\n")["a"]
    assert value == SCALARS[text]
    assert type(value) is type(SCALARS[text])


def test_names_may_be_dotted_nested_or_both(read):
    text = "/**:\n  ros__parameters:\n    a.b: 1\n    a: {c: 2, d.e: 3}\n"
    assert read(text) == {"a.b": 1, "a.c": 2, "a.d.e": 3}


NODES = """
reflest_estimator: {ros__parameters: {plain: 1, over: plain}}
/ns/reflest_estimator: {ros__parameters: {spelt: 1}}
ns: {reflest_estimator: {ros__parameters: {nested: 1}}}
/*: {ros__parameters: {star: 1}}
/ns/*: {ros__parameters: {in_ns: 1}}
/**/reflest_estimator: {ros__parameters: {anywhere: 1, over: anywhere}}
/**: {ros__parameters: {all: 1, over: all}}
camera: {ros__parameters: {of_another: 1}}
"""


@pytest.mark.parametrize(
    ("node", "names"),
    [
        ("/reflest_estimator", {"plain", "over", "star", "anywhere", "all"}),
        ("/ns/reflest_estimator", {"spelt", "nested", "in_ns", "anywhere", "over", "all"}),
        ("/a/b/reflest_estimator", {"anywhere", "over", "all"}),
        ("/camera", {"star", "all", "over", "of_another"}),
    ],
)
def test_the_sections_of_a_node_are_those_that_match_its_name(read, node, names):
    values = read(NODES, node)
    assert set(values) == names
    assert values["over"] == "all"


def test_a_replay_reads_the_estimators_section_among_others(read):
    text = "camera: {ros__parameters: {fps: 30}}\n"
    own = "robot: {reflest_estimator: {ros__parameters: {a: 1}}}\n"
    assert read(text + own) == {"a": 1}
    assert read("renamed: {ros__parameters: {a: 1}}\n") == {"a": 1}
    with pytest.raises(ParameterError, match=r"/robot/reflest_estimator and /b/reflest|keep one"):
        read(own + "b: {reflest_estimator: {ros__parameters: {a: 2}}}\n")
    with pytest.raises(ParameterError, match="/camera, /lidar, none for reflest_estimator"):
        read(text + "lidar: {ros__parameters: {a: 2}}\n")


def test_byte_order_mark_and_windows_line_ends_are_read(read):
    assert read(b"\xef\xbb\xbf/**:\r\n  ros__parameters:\r\n    b: 1\r\n") == {"b": 1}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "empty"),
        ("/**: {a: 1}", "expected names with values"),
        ("a: {b: {}}", "has no ros__parameters"),
        ("x: &a {ros__parameters: {b: 1}}\ny: *a\n", "line 2: ROS reads no aliases"),
        ("/**: {ros__parameters: {a: [[1], [2]]}}", "a holds more than a plain list"),
        ("{" * 40 + "}" * 40, "nested more than 32 deep|as YAML"),
        ("/**: {ros__parameters: {? [a] : 1}}", "a name must be text"),
        ("/**:\n\tros__parameters:", "cannot be read as YAML"),
        (b"\xff\xfe", "cannot be read as YAML"),
    ],
)
def test_what_is_no_parameter_file_is_refused_in_a_sentence(read, text, words):
    with pytest.raises(ParameterError, match=words) as refused:
        read(text)
    assert "p.yaml" in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("regions: {shape: sphere}", "regions.shape is no parameter: is region.shape meant?"),
        ("fusion.voxelsize: 0.01", "fusion.voxelsize is no parameter: is fusion.voxel_size meant?"),
        ("capture: {slopp: 0.1}", "capture.slopp is no parameter: is capture.slop meant?"),
        ("capture: {zzzzzz: 1}", "capture.zzzzzz is no parameter"),
    ],
)
def test_an_unknown_name_is_refused_with_the_nearest_known_one(tmp_path, written, meant):
    path = tmp_path / "p.yaml"
    path.write_text(f"/**:\n  ros__parameters:\n    {written}\n")
    with pytest.raises(ParameterError) as refused:
        ReflestSettings.from_yaml(path)
    assert meant in str(refused.value)


def test_dotted_names_and_exponents_reach_the_settings(tmp_path):
    path = tmp_path / "p.yaml"
    path.write_text(
        "/**:\n  ros__parameters:\n    region.shape: sphere\n    region.size: [1e-1, 2e-1, 3e-1]\n"
        "    fusion.voxel_size: 5e-3\n    use_sim_time: true\n    topics.rgb: /camera\n"
        "    qos_overrides./camera.subscription.depth: 5\n"
    )
    settings = ReflestSettings.from_yaml(path)
    assert settings.region.shape == "sphere"
    assert settings.region.size == (0.1, 0.2, 0.3)
    assert settings.fusion.voxel_size == 0.005


def test_a_folder_or_a_pipe_is_not_read(tmp_path):
    with pytest.raises(ParameterError, match="not a file"):
        read_parameter_file(tmp_path)


def test_a_name_that_resembles_none_may_be_another_nodes_and_is_warned_of(tmp_path):
    path, heard = tmp_path / "p.yaml", []
    path.write_text("/**:\n  ros__parameters:\n    qqq.zzz: 1\n    fusion.threads: 1\n")
    assert ReflestSettings.from_yaml(path, heard.append).fusion.threads == 1
    assert heard == [f"{path}: qqq.zzz is no parameter of reflest and has no effect"]
