# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Reads ROS 2 parameter files as ``rcl_yaml_param_parser`` does, without ROS.

Nodes may be nested or written with slashes, ``*`` stands for one part of a name and ``**`` for any
number. Names of parameters may be nested or dotted. Of several sections that apply, the later one
in the file wins. Numbers may have exponents without a point, as ``1e-3``, which YAML 1.1 reads as
text.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Callable, Collection, Iterator
from pathlib import Path
from typing import Any

import yaml

from reflest_core.parameter import ParameterError

NODE_NAME = "reflest_estimator"
SECTION = "ros__parameters"
OF_ROS = ("use_sim_time", "start_type_description_service", "qos_overrides.")
"""What every node has, and the prefix of the parameters that come with subscriptions."""
DEEPEST = 32
LONGEST_FILE = 2**20
"""Bytes; a longer one is no file of parameters."""

TRUE = frozenset(["Y", "y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"])
FALSE = frozenset(["N", "n", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"])
INTEGER = re.compile(r"[+-]?(0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)")
REAL = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
SPECIAL = re.compile(r"[+-]?\.?(inf|infinity|nan)", re.IGNORECASE)


def read_parameter_file(path: Path, node: str | None = None) -> dict[str, Any]:
    """Return the parameters that a file gives to a node.

    Args:
        path: The YAML file.
        node: Fully qualified name, as ``/robot/reflest_estimator``. None stands for
            ``reflest_estimator`` in the one namespace that the file names, or for the file's only
            node whatever its name.

    Returns:
        Values by dotted names, in the file's order.

    Raises:
        ParameterError: The file cannot be read, is no parameter file, or holds parameters of
            several nodes of which none, or more than one, is meant.
    """
    sections = list(_sections(_root(path), "", path))
    if not sections:
        raise ParameterError(f"{path} has no {SECTION} under a node name")
    names = [name for name, _ in sections]
    chosen = _names_offline(names, path) if node is None else None
    values: dict[str, Any] = {}
    for name, content in sections:
        if name in chosen if chosen is not None else _pattern(name).fullmatch(node or ""):
            values.update(_parameters(content, "", path))
    return values


def check_known(
    values: dict[str, Any],
    known: Collection[str],
    source: str,
    on_warning: Callable[[str], None] = lambda _: None,
) -> None:
    """Refuse a name that no parameter has, if it resembles one or is in a known group.

    Other names may be meant for another node that shares a section, as ``/**``.

    Args:
        values: Values by dotted names.
        known: All names; one that ends in a point stands for all that begin so.
        source: Where the values are from, for the sentence.
        on_warning: Called with a sentence on each unknown name that resembles none.

    Raises:
        ParameterError: It names the unknown and the nearest known one.
    """
    prefixes = tuple(name for name in (*known, *OF_ROS) if name.endswith("."))
    names = {*known, *OF_ROS}
    groups = {name.split(".")[0] for name in known}
    for name in values:
        if name not in names and not name.startswith(prefixes):
            meant = nearest(name, known)
            if meant or name.split(".")[0] in groups:
                raise ParameterError(f"{source}: {name} is no parameter{meant}")
            on_warning(f"{source}: {name} is no parameter of reflest and has no effect")


def nearest(name: str, known: Collection[str]) -> str:
    """Return a question that names the nearest known name, or "" where none is near.

    Args:
        name: What was written.
        known: Names that exist.
    """
    close = difflib.get_close_matches(name, list(known), 1)
    return f": is {close[0]} meant?" if close else ""


def _root(path: Path) -> yaml.Node:
    try:
        if not path.is_file():
            raise ParameterError(f"{path} cannot be read: it is not a file")
        with path.open("rb") as stream:
            data = stream.read(LONGEST_FILE + 1)
        text = data.decode("utf-8-sig")
        if len(data) > LONGEST_FILE:
            raise ParameterError(f"{path} is longer than {LONGEST_FILE} bytes: no parameter file")
        depth = 0
        for event in yaml.parse(text, Loader=yaml.SafeLoader):
            if isinstance(event, yaml.AliasEvent):
                line = _line(event)
                raise ParameterError(f"{path}, line {line}: ROS reads no aliases: write values out")
            depth += isinstance(event, yaml.CollectionStartEvent)
            depth -= isinstance(event, yaml.CollectionEndEvent)
            if depth > DEEPEST:
                raise ParameterError(f"{path} is nested more than {DEEPEST} deep")
        root = yaml.compose(text, Loader=yaml.SafeLoader)
    except OSError as error:
        raise ParameterError(f"{path} cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        reason = " ".join(str(error).split())
        raise ParameterError(f"{path} cannot be read as YAML ({reason})") from error
    if root is None:
        raise ParameterError(f"{path} is empty: it has no {SECTION}")
    return root


def _line(part: yaml.Node | yaml.Event) -> int:
    return part.start_mark.line + 1 if part.start_mark else 0


def _items(node: yaml.Node, path: Path) -> Iterator[tuple[str, yaml.Node]]:
    if not isinstance(node, yaml.MappingNode):
        line = _line(node)
        raise ParameterError(f"{path}, line {line}: expected names with values under {SECTION}")
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise ParameterError(f"{path}, line {_line(key)}: a name must be text")
        yield key.value, value


def _sections(node: yaml.Node, name: str, path: Path) -> Iterator[tuple[str, yaml.Node]]:
    """Yield the full name of every node in the file, and its parameters."""
    for key, value in _items(node, path):
        if key == SECTION:
            yield name or "/", value
        else:
            yield from _sections(value, f"{name}/{key.strip('/')}", path)


def _pattern(name: str) -> re.Pattern[str]:
    """Return the expression that matches the nodes of a section's name."""
    expression = ""
    for part in name.strip("/").split("/"):
        expression += {"**": r"(/[^/]+)*", "*": r"/[^/]+"}.get(part, f"/{re.escape(part)}")
    return re.compile(expression)


def _names_offline(names: list[str], path: Path) -> set[str]:
    """Return the sections that a replay, which has no name, reads."""
    wild = {name for name in names if name.split("/")[-1] in ("*", "**")}
    own = {name for name in names if name.split("/")[-1] == NODE_NAME}
    others = set(names) - wild - own
    placed = {name for name in own if "*" not in name}
    if len(placed) > 1:
        raise ParameterError(
            f"{path} has parameters for {' and '.join(sorted(placed))}: keep one of them"
        )
    if own or wild:
        return own | wild
    if len(others) > 1:
        raise ParameterError(
            f"{path} has parameters for {', '.join(sorted(others))}, none for {NODE_NAME}"
        )
    return others


def _parameters(node: yaml.Node, prefix: str, path: Path) -> Iterator[tuple[str, Any]]:
    for key, value in _items(node, path):
        name = f"{prefix}{key}"
        if isinstance(value, yaml.MappingNode):
            yield from _parameters(value, f"{name}.", path)
        elif isinstance(value, yaml.SequenceNode):
            scalars = [entry for entry in value.value if isinstance(entry, yaml.ScalarNode)]
            if len(scalars) != len(value.value):
                raise ParameterError(f"{path}: {name} holds more than a plain list")
            yield name, [_scalar(entry) for entry in scalars]
        elif isinstance(value, yaml.ScalarNode):
            yield name, _scalar(value)


def _scalar(node: yaml.ScalarNode) -> bool | int | float | str:
    """Return a value with the type that rcl gives it."""
    text: str = node.value
    if node.style:  # quoted, or a block of text
        return text
    if text in TRUE or text in FALSE:
        return text in TRUE
    if INTEGER.fullmatch(text):
        digits = text.lstrip("+-")
        base = 16 if digits[:2].lower() == "0x" else 8 if digits.startswith("0") else 10
        number = int(digits, base) * (-1 if text.startswith("-") else 1)
        return number if -(2**63) <= number < 2**63 else float(number)
    if REAL.fullmatch(text):
        return float(text) if math.isfinite(float(text)) else text
    return float(text.replace(".", "")) if SPECIAL.fullmatch(text) else text
