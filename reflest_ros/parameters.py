# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The node's ROS parameters, declared from the settings dataclasses of node and core."""

from __future__ import annotations

import dataclasses
import difflib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node
from rclpy.parameter import Parameter

from reflest_core.errors import ReflestError
from reflest_core.estimation.settings import ReflestSettings, with_values
from reflest_core.parameter import ParameterError, ParameterInfo, info_of
from reflest_ros.settings import NodeSettings

LIVE_GROUPS = ("preview", "voxels", "environment", "markers", "region", "keyframe", "estimation")
"""Groups whose parameters may change while the node runs; the rest is structural."""

QOS_OVERRIDES = "qos_overrides."
"""Parameters that appear with the subscription that they are for."""


@dataclass(frozen=True)
class NamedParameter:
    """One parameter under its full name, ``group.name``."""

    name: str
    default: Any
    info: ParameterInfo

    @property
    def is_live(self) -> bool:
        """Whether it may change while the node runs."""
        return self.name.split(".")[0] in LIVE_GROUPS


def all_parameters() -> Iterator[NamedParameter]:
    """Every parameter of the node, in the order of ``config/estimator.yaml``."""
    for tree in (NodeSettings(), ReflestSettings()):
        for group in dataclasses.fields(tree):
            settings = getattr(tree, group.name)
            for member in dataclasses.fields(settings):
                default = getattr(settings, member.name)
                yield NamedParameter(f"{group.name}.{member.name}", default, info_of(member))


def declare_parameters(node: Node) -> tuple[NodeSettings, ReflestSettings]:
    """Declare every parameter and return what the user set.

    Raises :class:`ParameterError` naming the parameter that is wrong.
    """
    for parameter in all_parameters():
        try:
            node.declare_parameter(
                parameter.name, _ros_value(parameter.default), _descriptor(parameter)
            )
        except (InvalidParameterValueException, InvalidParameterTypeException) as error:
            raise ParameterError(str(error)) from error
    return _settings_from({p.name: node.get_parameter(p.name).value for p in all_parameters()})


def warn_of_unknown_parameters(node: Node) -> None:
    """Name what was set at the start and is no parameter, for ROS passes over it in silence."""
    known = [parameter.name for parameter in all_parameters()]
    # rclpy tells of these nowhere else.
    for name in node._parameter_overrides:
        if node.has_parameter(name) or name.startswith(QOS_OVERRIDES):
            continue
        close = difflib.get_close_matches(name, known, 1)
        meant = f": is {close[0]} meant?" if close else ""
        node.get_logger().warning(f"{name} is no parameter and has no effect{meant}")


def guard_parameters(node: Node, apply: Callable[[ReflestSettings], None]) -> None:
    """Check every later change; ``apply`` takes it or refuses it with a :class:`ReflestError`."""

    def on_set(changes: list[Parameter]) -> SetParametersResult:
        values = {p.name: node.get_parameter(p.name).value for p in all_parameters()}
        values.update({change.name: change.value for change in changes if change.name in values})
        try:
            _, settings = _settings_from(values)
            apply(settings)
        except ReflestError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    node.add_on_set_parameters_callback(on_set)


def _settings_from(values: dict[str, Any]) -> tuple[NodeSettings, ReflestSettings]:
    trees: list[Any] = []
    for tree in (NodeSettings(), ReflestSettings()):
        groups = {}
        for group in dataclasses.fields(tree):
            prefix = f"{group.name}."
            given = {k.removeprefix(prefix): v for k, v in values.items() if k.startswith(prefix)}
            groups[group.name] = with_values(getattr(tree, group.name), given, group.name)
        trees.append(dataclasses.replace(tree, **groups))
    return trees[0], trees[1]


def _ros_value(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _descriptor(parameter: NamedParameter) -> ParameterDescriptor:
    info = parameter.info
    descriptor = ParameterDescriptor(
        description=describe(info), read_only=not parameter.is_live, additional_constraints=""
    )
    if info.choices:
        descriptor.additional_constraints = f"one of {', '.join(info.choices)}"
    if info.minimum is not None and info.maximum is not None:
        if isinstance(parameter.default, float):
            descriptor.floating_point_range = [
                FloatingPointRange(from_value=float(info.minimum), to_value=float(info.maximum))
            ]
        elif isinstance(parameter.default, int):
            descriptor.integer_range = [
                IntegerRange(from_value=int(info.minimum), to_value=int(info.maximum))
            ]
    return descriptor


def describe(info: ParameterInfo) -> str:
    """Description, unit, range and choices in one line."""
    text = info.description
    limits = []
    if info.unit:
        limits.append(f"unit: {info.unit}")
    if info.minimum is not None and info.maximum is not None:
        limits.append(f"range: {info.minimum:g} to {info.maximum:g}")
    elif info.minimum is not None:
        limits.append(f"at least {info.minimum:g}")
    elif info.maximum is not None:
        limits.append(f"at most {info.maximum:g}")
    if info.choices:
        limits.append(f"one of: {', '.join(info.choices)}")
    return f"{text} ({'; '.join(limits)})" if limits else text
