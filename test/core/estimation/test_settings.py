# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Settings from YAML: what is absent keeps its default, what is wrong is named."""

import pytest

from reflest_core.estimation.settings import ReflestSettings
from reflest_core.parameter import ParameterError


def read(tmp_path, text):
    path = tmp_path / "estimator.yaml"
    path.write_text(text)
    return ReflestSettings.from_yaml(path)


def test_given_values_replace_defaults(tmp_path):
    settings = read(
        tmp_path,
        "/**:\n  ros__parameters:\n    fusion: {voxel_size: 0.01}\n"
        "    region: {shape: box, centre: [1, 2, 3]}\n    use_sim_time: true\n",
    )
    assert settings.fusion.voxel_size == 0.01
    assert settings.fusion.max_depth == ReflestSettings().fusion.max_depth
    assert settings.region.centre == (1.0, 2.0, 3.0)
    assert settings.keyframe == ReflestSettings().keyframe


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ("fusion: {voxel_size: 5.0}", r"fusion\.voxel_size = 5.0 m is outside \[0.001, 0.1\] m"),
        (
            "fusion: {voxel_size: .nan}",
            r"voxel_size = nan is not a number: give a value within \[0.001, 0.1\] m$",
        ),
        ("estimation: {up: [0, .nan, 1]}", r"estimation\.up = nan is not a number: give a number$"),
        ("fusion: {voxel_size: small}", r"fusion\.voxel_size = 'small' is not a float"),
        ("fusion: {voxels: 5}", r"fusion\.voxels is no parameter"),
        ("fusion: 5", "fusion must hold names and values"),
        ("region: {shape: cube}", "'cube' is not one of none, box, sphere"),
        ("region: {centre: [1, 2]}", r"region\.centre needs 3 numbers, not 2"),
        ("region: {centre: [1, a, 2]}", "not a list of numbers"),
        ("estimation: {model: resnet}", "'resnet' is not one of lightnet"),
    ],
)
def test_a_wrong_value_is_named_with_its_range(tmp_path, values, message):
    with pytest.raises(ParameterError, match=message):
        read(tmp_path, f"/**:\n  ros__parameters:\n    {values}\n")


@pytest.mark.parametrize("text", ["", "a: b", "[1, 2", "node: {other: 1}", "42"])
def test_a_file_of_another_kind_is_named(tmp_path, text):
    with pytest.raises(ParameterError, match=r"estimator\.yaml"):
        read(tmp_path, text)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(ParameterError, match=r"nowhere\.yaml"):
        ReflestSettings.from_yaml(tmp_path / "nowhere.yaml")
