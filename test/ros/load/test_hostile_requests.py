# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Whatever a client sends, the node answers it and lives on; the tests share one node."""

from __future__ import annotations

import os
import time

import pytest
from feed import SOON
from geometry_msgs.msg import Point, Vector3
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from sphere_scene import CENTRE

from reflest_ros.srv import Estimate, ExportEstimate, LoadScan, SaveScan, SetRegion


@pytest.fixture(scope="module")
def scan(feed, peer):
    """A scan that must not be harmed; its number of voxels."""
    for _ in range(8):
        feed.send_good()
    return peer.call(Estimate, "estimate").estimate.voxel_count


@pytest.fixture(autouse=True)
def _unharmed(scan, node, peer):
    yield
    assert peer.call(GetState, "get_state").current_state.label == "active"
    answer = peer.call(Estimate, "estimate")
    assert answer.success, answer.message
    assert answer.estimate.voxel_count == scan
    assert node.is_running


PATHS = [
    "",
    "/",
    ".",
    "..",
    "~nosuchuser/x",
    "/dev/zero",
    "/proc/self/mem",
    "/etc/passwd",
    "../../etc/passwd",
    "x" * 250,
    "x" * 100_000,
    "no/such/folder/x",
]


@pytest.mark.parametrize("path", PATHS, ids=lambda path: path[:20])
@pytest.mark.parametrize("name", ["save", "load", "export"])
def test_a_path_that_cannot_be_used_is_an_answer(peer, name, path):
    kind = {"save": SaveScan, "load": LoadScan, "export": ExportEstimate}[name]
    more = {"format": "gltf"} if name == "export" else {}
    response = peer.call(kind, name, path=path, **more)
    if name == "save" and path == "x" * 250:
        assert "too long" in response.message or response.success
    else:
        assert not response.success
        assert response.message


def test_a_fifo_in_the_root_is_refused_at_once(peer, tmp_path):
    os.mkfifo(tmp_path / "fifo")
    asked = time.monotonic()
    assert not peer.call(LoadScan, "load", path=str(tmp_path / "fifo")).success
    assert not peer.call(SaveScan, "save", path=str(tmp_path / "fifo")).success
    assert time.monotonic() - asked < SOON


def test_a_link_out_of_the_root_is_not_written(peer, tmp_path, tmp_path_factory):
    (tmp_path / "link").symlink_to("/etc/hostname")
    assert not peer.call(SaveScan, "save", path=str(tmp_path / "link")).success


def test_mode_of_an_existing_file_is_kept(peer, tmp_path):
    path = tmp_path / "mine"
    path.write_text("old")
    path.chmod(0o600)
    assert peer.call(SaveScan, "save", path=str(path)).success
    assert path.stat().st_mode & 0o777 == 0o600


def test_a_bad_format_is_named_first(peer):
    response = peer.call(ExportEstimate, "export", format="vrml", path="x.vrml")
    assert "format = 'vrml' is not one of glb, gltf" in response.message


@pytest.mark.parametrize(
    "transition",
    [{"id": number} for number in (0, 1, 2, 3, 5, 6, 10, 60, 99, 255)]
    + [{"label": "nonsense"}, {"label": "configure"}, {"label": "x" * 10_000}],
    ids=lambda one: str(one)[:30],
)
def test_a_transition_that_is_not_possible_now_is_refused(peer, transition):
    answer = peer.call(ChangeState, "change_state", transition=Transition(**transition))
    assert not answer.success


def value(**fields):
    kind = next(iter(fields)).removesuffix("_value").upper()
    return ParameterValue(type=getattr(ParameterType, f"PARAMETER_{kind}"), **fields)


def vector(*numbers):
    return value(double_array_value=list(numbers))


PARAMETERS = [
    ("keyframe.interval", ParameterValue(type=99)),
    ("keyframe.interval", ParameterValue(type=ParameterType.PARAMETER_NOT_SET)),
    ("keyframe.interval", value(double_value=float("nan"))),
    ("no.such", value(double_value=1.0)),
    ("", value(double_value=1.0)),
    ("region.centre", vector(*[float("nan")] * 3)),
    ("region.centre", vector(1e308, 0.0, 0.0)),
    ("region.centre", vector(0.0, 0.0)),
    ("region.centre", vector()),
    ("region.size", vector(*[float("inf")] * 3)),
    ("region.size", vector(*[1e308] * 3)),
    ("estimation.up", vector(0.0, 0.0, 0.0)),
    ("estimation.up", vector(1e-300, 0.0, 0.0)),
    ("estimation.up", vector(1e300, 0.0, 0.0)),
    ("estimation.weights", value(string_value="x" * 100_000)),
    ("estimation.weights", value(string_value="~nosuchuser/x")),
    ("estimation.weights", value(string_value="/dev/zero")),
    ("estimation.weights", value(string_value="/")),
    ("estimation.known_light", value(string_value="/no/such.hdr")),
    ("estimation.known_light", value(string_value="/dev/zero")),
    ("files.root", value(string_value="/")),
    ("autosave.path", value(string_value="/etc/passwd")),
]


@pytest.mark.parametrize("atomic", [False, True], ids=["one by one", "atomic"])
@pytest.mark.parametrize(("name", "bad"), PARAMETERS, ids=lambda one: str(one)[:30])
def test_a_parameter_that_cannot_be_used_is_refused_with_a_reason(peer, name, bad, atomic):
    parameters = [Parameter(name=name, value=bad)]
    if atomic:
        service, kind = "set_parameters_atomically", SetParametersAtomically
        result = peer.call(kind, service, parameters=parameters).result
    else:
        (result,) = peer.call(SetParameters, "set_parameters", parameters=parameters).results
    assert not result.successful
    assert result.reason


def test_a_set_of_parameters_takes_effect_whole_or_not_at_all(peer):
    answer = peer.call(
        SetParametersAtomically,
        "set_parameters_atomically",
        parameters=[
            Parameter(name="region.size", value=vector(0.3, 0.3, 0.3)),
            Parameter(name="estimation.weights", value=value(string_value="/nope")),
        ],
    )
    assert not answer.result.successful
    assert list(peer.parameter("region.size").double_array_value) == [0.35, 0.35, 0.35]


def test_questions_about_unknown_parameters_are_answered(peer):
    peer.call(DescribeParameters, "describe_parameters", names=["nope", ""])
    peer.call(GetParameters, "get_parameters", names=["nope", ""])
    peer.call(ListParameters, "list_parameters", prefixes=["", ".."], depth=2**63)


@pytest.mark.parametrize(
    "bad",
    [
        {"shape": 77},
        {"shape": 2, "centre": Point(x=float("nan"))},
        {"shape": 2, "size": Vector3(x=1e308, y=1.0, z=1.0)},
        {"shape": 1, "size": Vector3(x=float("inf"))},
    ],
    ids=str,
)
def test_a_region_that_cannot_be_is_refused(peer, bad):
    assert not peer.call(SetRegion, "set_region", **bad).success
    assert list(peer.parameter("region.centre").double_array_value) == CENTRE.tolist()


def test_services_answer_while_many_are_called(peer):
    """The quick ones are not behind the slow ones."""
    asked = time.monotonic()
    for _ in range(5):
        assert peer.call(GetState, "get_state").current_state.label == "active"
    assert time.monotonic() - asked < SOON
