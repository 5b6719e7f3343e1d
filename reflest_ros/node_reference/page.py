# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The page, section by section, as Markdown."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from rclpy.qos import QoSProfile

from reflest_core.capture.refusal import RefusalCause
from reflest_core.errors import ReflestError
from reflest_core.parameter import ParameterInfo
from reflest_ros.node import EstimatorNode
from reflest_ros.node_reference.descriptions import (
    CONDITIONAL,
    DIAGNOSTICS,
    OUTPUTS,
    REFUSALS,
    diagnostic_pattern,
)
from reflest_ros.node_reference.input_table import input_rows
from reflest_ros.node_reference.interface_file import Section, read_interface
from reflest_ros.node_reference.live_node import NodeFacts
from reflest_ros.parameters import NamedParameter, all_parameters

ROOT = Path(__file__).resolve().parents[2]

HEADER = """\
# The node

`ros2 run reflest_ros estimator` starts it, `ros2 launch reflest_ros estimator.launch.py` with a
parameter file. Names are relative, so that a namespace moves them all; full names below are those
without one. This page is written by `python -m reflest_ros.node_reference > docs/node.md` from the
code and from a node that runs; a test compares the two.
"""

MESSAGES = ("BrdfEstimate", "MaterialMap", "Material")

VIEWS = """\
Preview, voxels, environment and markers are made at keyframes and on `~/estimate`, outside the
fusion thread, and only where someone subscribes; a late subscriber gets the last keyframe at once.
RViz and Foxglove show them without plug-ins: `config/reflest.rviz`, `config/foxglove_layout.json`.
`python -m reflest_ros.demo.pictures` renders the pictures below from the messages of the shipped
capture; they are not screenshots. [environment.md](environment.md) describes the light.

![The sphere of the preview](images/view-preview.png)
![The cloud in its three colourings](images/view-voxels.png)
![The markers around the cloud](images/view-markers.png)
![The light around the object](images/view-environment.png)
"""


class UndescribedError(ReflestError):
    """The node offers something without a description, or a description has no counterpart."""


def page(facts: NodeFacts) -> str:
    """Write the whole page.

    Args:
        facts: read from a running node.

    Returns:
        Markdown.

    Raises:
        UndescribedError: A topic, diagnostic or cause of refusal is not described.
    """
    sections = (
        HEADER,
        _lifecycle(),
        _inputs(),
        _outputs(facts),
        VIEWS,
        *(_message(name) for name in MESSAGES),
        _services(facts),
        _parameters(),
        _diagnostics(facts),
    )
    return "\n".join(section.rstrip("\n") + "\n" for section in sections)


def _lifecycle() -> str:
    rows = []
    for name in ("configure", "activate", "deactivate", "cleanup", "shutdown"):
        sentence = (getattr(EstimatorNode, f"on_{name}").__doc__ or "").split("\n")[0]
        rows.append((f"`{name}`", sentence))
    heading = (
        "## Lifecycle\n\n`ros2 run` configures and activates it, see `lifecycle.autostart`.\n\n"
    )
    return heading + _table(("transition", "what it does"), rows)


def _inputs() -> str:
    rows = [
        (
            f"`{row.name}`",
            f"`{row.default}`",
            "<br>".join(f"`{t}`" for t in row.message_types),
            _qos(row.qos),
            row.description,
        )
        for row in input_rows()
    ]
    headings = ("remap", "else parameter `topics.*`, default", "type", "QoS asked for", "what")
    return (
        "## Topics in\n\nEach topic's QoS can be overridden by the parameters "
        "`qos_overrides.TOPIC.subscription.{reliability,durability,history,depth}`;\n"
        "`input.reliability` sets that of all but tf.\n\n" + _table(headings, rows)
    )


def _outputs(facts: NodeFacts) -> str:
    _same("topic", (topic.name for topic in facts.topics), OUTPUTS)
    rows = [
        (f"`{topic.name}`", f"`{topic.message_type}`", _qos(topic.qos), OUTPUTS[topic.name])
        for topic in facts.topics
    ]
    return "## Topics out\n\n" + _table(("topic", "type", "QoS offered", "what"), rows)


def _message(name: str) -> str:
    (section,) = read_interface(ROOT / "msg" / f"{name}.msg")
    return f"## reflest_ros/msg/{name}\n\n{section.comment}\n\n" + _fields(section)


def _services(facts: NodeFacts) -> str:
    parts = ["## Services\n\nUnder the node's name; each answers `success` and `message`.\n"]
    rows = [(f"`~/{s.name}`", f"`{s.service_type}`", s.description) for s in facts.services]
    parts.append(_table(("service", "type", "what"), rows))
    for name in sorted({s.service_type for s in facts.services}):
        package, _, kind = name.split("/")
        if package == "reflest_ros":
            request, response = read_interface(ROOT / "srv" / f"{kind}.srv")
            parts.append(f"### {name}\n\n{request.comment}\n")
            if request.fields:
                parts.append("Request:\n\n" + _fields(request))
            parts.append("Response:\n\n" + _fields(response))
    return "\n".join(parts)


def _parameters() -> str:
    parts = [
        "## Parameters\n\n`config/estimator.yaml` holds them all with their defaults. The column "
        "*set* says when a parameter may change. Several parameters in one request are checked "
        "together before any takes effect. A value that cannot be used is refused with the reason, "
        "and the old one stays.\n"
    ]
    groups: dict[str, list[NamedParameter]] = {}
    for parameter in all_parameters():
        groups.setdefault(parameter.name.split(".")[0], []).append(parameter)
    for group, members in groups.items():
        rows = [
            (
                f"`{one.name}`",
                f"`{_literal(one.default)}`",
                one.info.unit,
                _limits(one.info),
                one.change.value,
                one.info.description,
            )
            for one in members
        ]
        table = _table(("parameter", "default", "unit", "range", "set", "what"), rows)
        parts.append(f"### {group}\n\n{table}")
    return "\n".join(parts)


def _diagnostics(facts: NodeFacts) -> str:
    roles = [key.removeprefix("messages ") for key in facts.diagnostics if "messages " in key]
    seen = {diagnostic_pattern(key, roles) for key in facts.diagnostics}
    _same("diagnostic", seen | set(CONDITIONAL), DIAGNOSTICS)
    _same("cause of refusal", RefusalCause, REFUSALS)
    keys = _table(("key", "what"), [(f"`{key}`", what) for key, what in DIAGNOSTICS.items()])
    causes = _table(
        ("cause", "what was refused"),
        [(f"`{cause.value}`", what) for cause, what in REFUSALS.items()],
    )
    return (
        "## Diagnostics\n\nThe level is WARN while something is wrong, and the message says what "
        f"and what to change. Unknown numbers are `nan`.\n\n{keys}\n### Causes of refusal\n"
        "\nThe first refusal of each cause is a warning in the log, with topic and parameter.\n"
        f"\n{causes}"
    )


def _same(kind: str, offered: Iterable[object], described: Iterable[object]) -> None:
    for one in set(offered) ^ set(described):
        raise UndescribedError(
            f"the {kind} {one} is offered or described, but not both: correct "
            "reflest_ros/node_reference/descriptions.py"
        )


def _fields(section: Section) -> str:
    rows = [
        (
            f"`{field.name}{f' = {field.value}' if field.value else ''}`",
            f"`{field.kind}`",
            field.comment,
        )
        for field in section.fields
    ]
    return _table(("field", "type", "what"), rows)


def _table(headings: tuple[str, ...], rows: Iterable[tuple[str | None, ...]]) -> str:
    lines = [headings, tuple("---" for _ in headings), *rows]
    cells = ([(cell or "").replace("|", "\\|").replace("\n", " ") for cell in row] for row in lines)
    return "".join(f"| {' | '.join(row)} |\n" for row in cells)


def _qos(qos: QoSProfile) -> str:
    words = (qos.reliability.name, qos.durability.name, qos.history.name)
    return f"{', '.join(words).lower().replace('_', ' ')} {qos.depth}"


def _literal(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    return str(list(value)) if isinstance(value, tuple) else f"{value}"


def _limits(info: ParameterInfo) -> str:
    if info.choices:
        return "<br>".join(f"`{choice}`" for choice in info.choices)
    if info.minimum is not None and info.maximum is not None:
        return f"{info.minimum:g} to {info.maximum:g}"
    if info.minimum is not None:
        return f"at least {info.minimum:g}"
    return "" if info.maximum is None else f"at most {info.maximum:g}"
