# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters: described and ranged, refused with the reason, and the YAML that lists them."""

from __future__ import annotations

import dataclasses

import pytest
from own_process import ROOT
from rcl_interfaces.msg import ParameterType, ParameterValue

from reflest_core.estimation.settings import ReflestSettings
from reflest_ros.parameter_file import parameter_file
from reflest_ros.parameters import all_parameters

BASE_FILE = ROOT / "config" / "estimator.yaml"


def double(value: float) -> ParameterValue:
    return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)


def string(value: str) -> ParameterValue:
    return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=value)


def test_base_file_is_what_the_settings_say():
    assert BASE_FILE.read_text() == parameter_file(), (
        "run: python -m reflest_ros.parameter_file > config/estimator.yaml"
    )


def test_core_reads_the_base_file_as_its_defaults():
    assert ReflestSettings.from_yaml(BASE_FILE) == ReflestSettings()


def test_every_parameter_is_described(node, peer):
    named = list(all_parameters())
    described = peer.describe([parameter.name for parameter in named])
    for parameter, descriptor in zip(named, described, strict=True):
        assert parameter.info.description in descriptor.description
        assert parameter.info.unit in descriptor.description
        is_ranged = parameter.info.minimum is not None and parameter.info.maximum is not None
        if is_ranged and isinstance(parameter.default, float):
            (limits,) = descriptor.floating_point_range
            assert limits.from_value == parameter.info.minimum
            assert limits.to_value == parameter.info.maximum


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("keyframe.rotation", double(720.0), "180"),
        ("keyframe.interval", double(float("nan")), "keyframe.interval"),
        ("estimation.model", string("crystal-ball"), "grouplet-fast"),
        ("estimation.weights", string("/no/such/weights"), "/no/such/weights"),
        ("estimation.min_voxels", double(3.0), "type"),
        ("fusion.voxel_size", double(0.02), "while the node is unconfigured"),
        ("autosave.period", double(1.0), "only when the node is started"),
    ],
)
def test_a_bad_value_is_refused_with_the_reason_and_the_old_one_kept(
    node, peer, name, value, reason
):
    before = peer.parameter(name)
    result = peer.set_parameter(name, value)
    assert not result.successful
    assert reason in result.reason
    assert peer.parameter(name) == before


def test_a_good_value_is_taken(node, peer):
    assert peer.set_parameter("keyframe.rotation", double(30.0)).successful
    assert peer.parameter("keyframe.rotation").double_value == 30.0


def test_a_bad_start_ends_with_one_sentence(start):
    sentences = {
        "fusion.voxel_size:=5.0": "fusion.voxel_size",
        "fusion.voxel_size:=fine": "fusion.voxel_size",
        "estimation.weights:=/no/such/weights": "/no/such/weights",
        "region.size:=[1.0, 1.0]": "region.size needs 3 numbers",
        "autosave.path:=/no/such/folder/scan": "/no/such/folder",
    }
    processes = {
        override: start("reflest_ros.estimator", "--ros-args", "-p", override)
        for override in sentences
    }
    for override, process in processes.items():
        assert process.exit_code() == 2, process.output
        assert sentences[override] in process.output
        assert len(process.lines_with("error:")) == 1
        assert "Traceback" not in process.output


def test_a_parameter_that_does_not_exist_is_named(start):
    process = start(
        "reflest_ros.estimator",
        "--ros-args",
        "-p",
        "lifecycle.autostart:=false",
        "-p",
        "fusion.voxelsize:=0.01",
        "-p",
        "qos_overrides./x.subscription.depth:=1",
    )
    process.wait_for_line("waiting to be configured")
    (warning,) = process.lines_with("is not a parameter")
    assert "fusion.voxelsize" in warning
    assert "fusion.voxel_size" in warning


def test_every_group_is_in_the_file():
    text = BASE_FILE.read_text()
    for group in dataclasses.fields(ReflestSettings()):
        assert f"    {group.name}:" in text


@pytest.mark.parametrize(
    ("content", "sentence"),
    [("a: [1,\n", "params file"), (None, "Error opening YAML file")],
    ids=["not YAML", "not there"],
)
def test_a_parameter_file_that_cannot_be_read_is_one_sentence(start, tmp_path, content, sentence):
    path = tmp_path / "bad.yaml"
    if content is not None:
        path.write_text(content)
    process = start("reflest_ros.estimator", "--ros-args", "--params-file", path)
    assert process.exit_code() == 2, process.output
    (line,) = process.lines_with("reflest: error:")
    assert sentence in line
    assert ".c:" not in line
    assert "Traceback" not in process.output


def test_enforced_security_without_keys_is_one_sentence(start):
    process = start(
        "reflest_ros.estimator", ROS_SECURITY_ENABLE="true", ROS_SECURITY_STRATEGY="Enforce"
    )
    assert process.exit_code() == 2, process.output
    assert len(process.lines_with("error:")) == 1
    assert "ROS_SECURITY_KEYSTORE" in process.output
    assert "Traceback" not in process.output
