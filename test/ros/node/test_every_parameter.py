# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Each parameter takes effect when it may change, or is refused: none is accepted and ignored."""

from __future__ import annotations

from typing import Any

import pytest
import rclpy
from lifecycle_msgs.msg import Transition
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter

from reflest_core.parameter import ParameterInfo
from reflest_ros.node import EstimatorNode
from reflest_ros.outputs.view_settings import read_settings
from reflest_ros.parameters import Change, all_parameters
from reflest_ros.process import ros_process
from reflest_ros.settings import NodeSettings

PARAMETERS = list(all_parameters())
STRINGS = {
    "region.shape": "sphere",
    "estimation.model": "hemicnn",
    "capture.pose_source": "odom",
    "capture.world_frame": "odom",
}
"""Values of parameters for which a word of our choice would not do."""
NEEDS_A_FILE = ("estimation.weights", "estimation.known_light", "estimation.device")
"""Parameters that are tested on their own below: another value needs a file or a device."""


def other_value(name: str, default: Any, info: ParameterInfo) -> Any:
    """A valid value that is not the default."""
    if name in STRINGS:
        return STRINGS[name]
    if info.choices:
        return next(choice for choice in info.choices if choice != default)
    if isinstance(default, bool):
        return not default
    if isinstance(default, (int, float)):
        least = default / 2 if info.minimum is None else info.minimum
        most = default * 2 if info.maximum is None else info.maximum
        other = (default + (most if default != most else least)) / 2
        return int(other) if isinstance(default, int) else other
    if isinstance(default, tuple):
        return [0.0, -1.0, 0.0] if name == "estimation.up" else [0.5] * 3 + [0.0] * 3 + [1.0]
    return "another_name"


def used(node: EstimatorNode, name: str) -> Any:
    """The value of a parameter where it is used, as far as it is kept there."""
    group, member = name.split(".")
    session = node._session
    if group in ("preview", "voxels", "environment", "markers", "materials"):
        kind = type(getattr(NodeSettings(), group))
        return getattr(read_settings(node, group, kind), member)
    if group == "region":
        return getattr(session.scanner.scan.region_settings, member)
    if group == "keyframe":
        return getattr(session.scanner.keyframes.settings, member)
    if group == "estimation":
        return getattr(session.scanner.estimator.settings, member)
    if group == "fusion":
        return getattr(session.scanner.scan.fusion, member)
    if group == "capture":
        return getattr(session.assembler._settings, member)
    return getattr(getattr(session.node_settings, group), member)


@pytest.fixture(scope="module")
def node(domain_id):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain_id))
        with ros_process(["--ros-args", "-p", "lifecycle.autostart:=false"]):
            node = EstimatorNode()
            executor = SingleThreadedExecutor()
            executor.add_node(node)
            yield node
            node.destroy_node()
            executor.shutdown()
    assert not rclpy.ok()


@pytest.fixture
def unconfigured(node):
    if node.is_active is not None:
        node.change(Transition.TRANSITION_CLEANUP)
    return node


@pytest.fixture
def configured(node):
    if node.is_active is None:
        node.change(Transition.TRANSITION_CONFIGURE)
    return node


def set_value(node, name, value):
    return node.set_parameters_atomically([Parameter(name, value=value)])


def plain(value):
    return list(value) if isinstance(value, tuple) else value


def chosen(change):
    return [one for one in PARAMETERS if one.change is change and one.name not in NEEDS_A_FILE]


@pytest.mark.parametrize("parameter", chosen(Change.LIVE), ids=lambda one: one.name)
def test_a_live_parameter_takes_effect_at_once(configured, parameter):
    default = plain(parameter.default)
    other = other_value(parameter.name, parameter.default, parameter.info)
    other = other[: len(default)] if isinstance(default, list) else other
    result = set_value(configured, parameter.name, other)
    assert result.successful, result.reason
    assert plain(used(configured, parameter.name)) == other != default
    assert set_value(configured, parameter.name, default).successful
    assert plain(used(configured, parameter.name)) == default


@pytest.mark.parametrize("parameter", chosen(Change.START), ids=lambda one: one.name)
def test_a_parameter_of_the_start_is_refused_later(configured, parameter):
    before = configured.get_parameter(parameter.name).value
    changed = other_value(parameter.name, before, parameter.info)
    result = set_value(configured, parameter.name, changed)
    assert not result.successful
    assert "only when the node is started" in result.reason
    assert set_value(configured, parameter.name, before).successful, "the same value is no change"


@pytest.mark.parametrize("parameter", chosen(Change.UNCONFIGURED), ids=lambda one: one.name)
def test_another_parameter_is_refused_while_configured(configured, parameter):
    default = plain(parameter.default)
    other = other_value(parameter.name, parameter.default, parameter.info)
    other = other[: len(default)] if isinstance(default, list) else other
    result = set_value(configured, parameter.name, other)
    assert not result.successful
    assert "while the node is unconfigured" in result.reason
    assert set_value(configured, parameter.name, default).successful, "the same value is no change"


def test_those_parameters_take_effect_at_the_next_configuration(unconfigured):
    changed = {}
    for one in chosen(Change.UNCONFIGURED):
        default = plain(one.default)
        other = other_value(one.name, one.default, one.info)
        if one.name == "fusion.memory_budget_mb":
            other = 64.0
        changed[one.name] = other[: len(default)] if isinstance(default, list) else other
    for name, value in changed.items():
        result = set_value(unconfigured, name, value)
        assert result.successful, (name, result.reason)
    unconfigured.change(Transition.TRANSITION_CONFIGURE)
    for name, value in changed.items():
        assert plain(used(unconfigured, name)) == value, name
    unconfigured.change(Transition.TRANSITION_CLEANUP)
    for one in chosen(Change.UNCONFIGURED):
        assert set_value(unconfigured, one.name, plain(one.default)).successful


@pytest.mark.parametrize("name", ["estimation.weights", "estimation.known_light"])
def test_a_file_that_is_not_there_is_refused(configured, name):
    result = set_value(configured, name, "/no/such/file")
    assert not result.successful
    assert "/no/such/file" in result.reason
    assert used(configured, name) == ""


def test_a_known_light_is_used_at_once(configured, tmp_path):
    path = tmp_path / "room.hdr"
    header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n"
    path.write_bytes(header + b"\x80\x80\x80\x80" * (16 * 32))
    assert configured._session.scanner._known_light is None
    assert set_value(configured, "estimation.known_light", str(path)).successful
    assert configured._session.scanner._known_light is not None
    assert set_value(configured, "estimation.known_light", "").successful
    assert configured._session.scanner._known_light is None


def test_every_parameter_is_in_one_of_the_tests():
    groups = {one.name for change in Change for one in chosen(change)}
    assert groups | set(NEEDS_A_FILE) == {one.name for one in PARAMETERS}
