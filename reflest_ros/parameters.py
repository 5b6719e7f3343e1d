# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The node's ROS parameters, declared from the settings dataclasses of node and core."""

from __future__ import annotations

import dataclasses
import difflib
import enum
import traceback
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
from reflest_core.fusion.settings import RegionSettings
from reflest_core.parameter import ParameterError, ParameterInfo, info_of
from reflest_ros.settings import NodeSettings

LIVE_GROUPS = (
    "preview",
    "voxels",
    "environment",
    "markers",
    "materials",
    "region",
    "keyframe",
    "estimation",
)
"""Groups that take effect while the node runs."""

START_GROUPS = ("files", "lifecycle", "autosave")
"""Groups that whoever starts the node decides; the network cannot change them."""

START_PARAMETERS = ("input.diagnostics_period",)
"""Further parameters that are read at the start only."""

QOS_OVERRIDES = "qos_overrides."
"""Parameters that appear with the subscription that they are for."""


class Change(enum.Enum):
    """When a parameter may change."""

    LIVE = "at any time"
    UNCONFIGURED = "while the node is unconfigured"
    START = "at the start"


@dataclass(frozen=True)
class NamedParameter:
    """One parameter under its full name.

    Attributes:
        name: ``group.name``.
        default: Its value where nobody sets it.
        info: Description, unit and range.
    """

    name: str
    default: Any
    info: ParameterInfo

    @property
    def change(self) -> Change:
        """When it may change."""
        group = self.name.split(".")[0]
        if group in LIVE_GROUPS:
            return Change.LIVE
        if group in START_GROUPS or self.name in START_PARAMETERS:
            return Change.START
        return Change.UNCONFIGURED


def all_parameters() -> Iterator[NamedParameter]:
    """List every parameter of the node.

    Yields:
        The parameters in the order of ``config/estimator.yaml``.
    """
    for tree in (NodeSettings(), ReflestSettings()):
        for group in dataclasses.fields(tree):
            settings = getattr(tree, group.name)
            for member in dataclasses.fields(settings):
                default = getattr(settings, member.name)
                yield NamedParameter(f"{group.name}.{member.name}", default, info_of(member))


def declare_parameters(node: Node) -> tuple[NodeSettings, ReflestSettings]:
    """Declare every parameter.

    Args:
        node: The node that gets the parameters.

    Returns:
        The values that were set at the start, defaults elsewhere.

    Raises:
        ParameterError: It names the parameter that is wrong.
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
    """Log a warning for each value set at the start that is no parameter; ROS ignores these.

    Args:
        node: After :func:`declare_parameters`.
    """
    known = [parameter.name for parameter in all_parameters()]
    # rclpy has no public list of these.
    for name in node._parameter_overrides:
        if node.has_parameter(name) or name.startswith(QOS_OVERRIDES):
            continue
        close = difflib.get_close_matches(name, known, 1)
        meant = f": did you mean {close[0]}?" if close else ""
        node.get_logger().warning(f"{name} is not a parameter and has no effect{meant}")


Prepare = Callable[[NodeSettings, ReflestSettings], Callable[[], None]]


class ParameterGuard:
    """Checks a set of changed parameters as a whole, and only then lets it take effect."""

    def __init__(self, node: Node, prepare: Prepare, is_configured: Callable[[], bool]) -> None:
        """Watch the parameters of a node.

        Args:
            node: After :func:`declare_parameters`.
            prepare: Loads and checks what the new settings need, changes nothing, and returns what
                puts them to use; a :class:`ReflestError` refuses them.
            is_configured: Whether the node is configured now.
        """
        self._node = node
        self._prepare = prepare
        self._is_configured = is_configured
        self._put_to_use: Callable[[], None] | None = None
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._apply)

    def _check(self, changes: list[Parameter]) -> SetParametersResult:
        self._put_to_use = None
        try:
            self._put_to_use = self._checked(changes)
        except ReflestError as error:
            return SetParametersResult(successful=False, reason=str(error))
        except (OSError, ValueError) as error:  # of a path that the system does not take
            return SetParametersResult(successful=False, reason=f"it cannot be used: {error}")
        except Exception as error:
            trace = "".join(traceback.format_exception(error)).rstrip()
            self._node.get_logger().error(f"internal error, please report it: {trace}")
            return SetParametersResult(successful=False, reason=f"internal error: {error!r}")
        return SetParametersResult(successful=True)

    def _checked(self, changes: list[Parameter]) -> Callable[[], None] | None:
        known = {parameter.name: parameter for parameter in all_parameters()}
        values = {name: self._node.get_parameter(name).value for name in known}
        before = _settings_from(values)
        for change in changes:
            if not change.name:
                raise ParameterError("a parameter without a name cannot be set")
            if change.name in known:
                if change.type_ == Parameter.Type.NOT_SET:
                    raise ParameterError(f"{change.name} cannot be unset")
                values[change.name] = change.value
        after = _settings_from(values)
        for name, parameter in known.items():
            if _value_of(before, name) != _value_of(after, name):
                self._check_change(name, parameter.change)
        return None if after == before else self._prepare(*after)

    def _check_change(self, name: str, change: Change) -> None:
        if change is Change.START:
            raise ParameterError(f"{name} can be set only when the node is started")
        if change is Change.UNCONFIGURED and self._is_configured():
            raise ParameterError(
                f"{name} can change only while the node is unconfigured: deactivate it and "
                "clean it up first"
            )

    def _apply(self, _: list[Parameter]) -> None:
        put_to_use, self._put_to_use = self._put_to_use, None
        if put_to_use is not None:
            put_to_use()


def set_region_parameters(node: Node, region: RegionSettings) -> None:
    """Set the three parameters of the region of interest together.

    Args:
        node: Its :class:`ParameterGuard` hands a changed region to the scan.
        region: The new region.

    Raises:
        ParameterError: With the reason why they are refused.
    """
    result = node.set_parameters_atomically(
        [
            Parameter("region.shape", value=region.shape),
            Parameter("region.centre", value=list(region.centre)),
            Parameter("region.size", value=list(region.size)),
        ]
    )
    if not result.successful:
        raise ParameterError(result.reason)


def _value_of(trees: tuple[NodeSettings, ReflestSettings], name: str) -> Any:
    group, member = name.split(".")
    tree = trees[0] if hasattr(trees[0], group) else trees[1]
    return getattr(getattr(tree, group), member)


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
    constraints = [f"may change {parameter.change.value}"]
    if info.choices:
        constraints.append(f"one of {', '.join(info.choices)}")
    descriptor = ParameterDescriptor(
        description=describe(info), additional_constraints="; ".join(constraints)
    )
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
    """Describe a parameter in one line.

    Args:
        info: As declared with the setting.

    Returns:
        Description, unit, range and choices.
    """
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
