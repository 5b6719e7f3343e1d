# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""All tuning of a scan in one tree, as ``config/estimator.yaml`` writes it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from reflest_core.capture.settings import CaptureSettings
from reflest_core.fusion.settings import FusionSettings, KeyframeSettings, RegionSettings
from reflest_core.models.registry import DEVICES, models
from reflest_core.parameter import ParameterError, check_parameters, parameter
from reflest_core.parameter_file import check_known, read_parameter_file

NODE_GROUPS = (
    "lifecycle",
    "autosave",
    "files",
    "topics",
    "input",
    "preview",
    "voxels",
    "environment",
    "markers",
    "materials",
)
"""Groups that the ROS node has beside these; its parameter files hold both."""

SHORTEST_UP, LONGEST_UP = 1e-3, 1e3
"""Limits of the length of ``up``: what lies outside is a mistake and loses all precision."""


@dataclass(frozen=True)
class EstimationSettings:
    """The network, and the thresholds below which an estimate gets a warning."""

    model: str = parameter("lightnet", "The network that estimates.", choices=tuple(models()))
    weights: str = parameter(
        "",
        "Weight file for a single material and for one among others, in place of the shipped two.",
    )
    device: str = parameter(
        "cpu", "Where the network runs; cuda needs PyTorch and a CUDA device.", choices=DEVICES
    )
    threads: int = parameter(
        1, "CPU threads of the network; fusion has its own.", minimum=1, maximum=64
    )
    min_voxels: int = parameter(
        10, "With fewer observed voxels there is no estimate.", minimum=1, maximum=1000
    )
    up: tuple[float, float, float] = parameter(
        (0.0, 0.0, 1.0),
        "Up in the world frame of the poses. Maps that begin at a level camera: 0, -1, 0.",
    )
    known_light: str = parameter(
        "",
        "An .hdr or .exr panorama of the room, or an earlier scan saved there, in the world frame "
        "of the poses: stands in for the light that no camera saw. A folder of such, of one or "
        "more rooms in any turn about the vertical: the one that fits is taken.",
    )
    low_coverage: float = parameter(
        0.15,
        "Below this share of each voxel's view directions an estimate is marked LOW_COVERAGE.",
        minimum=0.0,
        maximum=1.0,
    )
    low_light: float = parameter(
        0.1,
        "Below this share of the directions that light the surface, as the background showed them, "
        "lightnet's estimate is marked LOW_LIGHT.",
        minimum=0.0,
        maximum=1.0,
    )
    clipped_light: float = parameter(
        0.6,
        "Above this share of the light from overexposed background lightnet's estimate is marked "
        "CLIPPED_LIGHT.",
        minimum=0.0,
        maximum=1.0,
    )
    gloss_voxels: int = parameter(
        200,
        "Voxels of one material whose highlights determine lightnet's alpha, at about 0.1 ms each; "
        "fewer leave more uncertainty.",
        minimum=30,
        maximum=10000,
    )
    budget: float = parameter(
        0.0,
        "Seconds that an estimate of lightnet may take; where one takes longer, the next ones use "
        "less of the evidence, down to a quarter, and say so. Estimates then depend on the "
        "computer's speed. 0 sets no limit. Without a region, what divides the scan into materials "
        "is not shortened.",
        minimum=0.0,
        maximum=60.0,
    )
    gloss_information: float = parameter(
        40.0,
        "With less log-likelihood over that of a matte surface lightnet's alpha cannot be "
        "determined from highlights, and an estimate is marked UNCERTAIN_GLOSS.",
        minimum=0.0,
        maximum=1e6,
    )

    def __post_init__(self) -> None:
        check_parameters(self)
        length = math.hypot(*self.up)
        if not SHORTEST_UP <= length <= LONGEST_UP:
            raise ParameterError(
                f"up = {self.up} is no direction: its length must lie in [{SHORTEST_UP:g}, "
                f"{LONGEST_UP:g}]"
            )


@dataclass(frozen=True)
class ReflestSettings:
    """One group of parameters for each stage; a parameter's full name is ``group.name``."""

    capture: CaptureSettings = field(default_factory=CaptureSettings)
    region: RegionSettings = field(default_factory=RegionSettings)
    fusion: FusionSettings = field(default_factory=FusionSettings)
    keyframe: KeyframeSettings = field(default_factory=KeyframeSettings)
    estimation: EstimationSettings = field(default_factory=EstimationSettings)

    @staticmethod
    def from_values(values: dict[str, dict[str, Any]]) -> ReflestSettings:
        """Build from ``{group: {name: value}}``; what is absent keeps its default.

        Raises :class:`ParameterError` for an unknown name, a wrong type or a value out of range.

        Args:
            values: by group, then by name.
        """
        defaults = ReflestSettings()
        groups = {
            group.name: getattr(defaults, group.name) for group in dataclasses.fields(defaults)
        }
        for name, given in values.items():
            if name not in groups:
                raise ParameterError(f"{name} is no parameter group; there are {', '.join(groups)}")
            groups[name] = with_values(groups[name], given, name)
        return ReflestSettings(**groups)

    @staticmethod
    def from_yaml(
        path: Path, on_warning: Callable[[str], None] = lambda _: None
    ) -> ReflestSettings:
        """Read a ROS 2 parameter file as the node does; the node's own groups are passed over.

        Args:
            path: The file; :mod:`reflest_core.parameter_file` says which of its nodes is read.
            on_warning: Called with a sentence on each name that seems to be another node's.

        Returns:
            The settings; what the file does not name keeps its default.

        Raises:
            ParameterError: The file cannot be read, or a name, type or value is wrong.
        """
        values = read_parameter_file(path)
        tree = ReflestSettings()
        groups = [group.name for group in dataclasses.fields(tree)]
        known = [
            f"{group}.{member.name}"
            for group in groups
            for member in dataclasses.fields(getattr(tree, group))
        ]
        for group in groups:
            if group in values:
                raise ParameterError(f"{group} must hold names and values, not {values[group]!r}")
        check_known(
            values, [*known, *(f"{group}." for group in NODE_GROUPS)], str(path), on_warning
        )
        nested: dict[str, dict[str, Any]] = {}
        for name, value in values.items():
            group, _, member = name.partition(".")
            if group in groups:
                nested.setdefault(group, {})[member] = value
        return ReflestSettings.from_values(nested)


def with_values(group: Any, given: dict[str, Any], group_name: str) -> Any:
    """A copy of the settings ``group`` with ``given`` values, checked for type and range.

    Args:
        group: the defaults.
        given: values by name.
        group_name: for sentences.
    """
    if not isinstance(given, dict):
        raise ParameterError(f"{group_name} must hold names and values, not {given!r}")
    changes: dict[str, Any] = {}
    for name, value in given.items():
        if name not in {known.name for known in dataclasses.fields(group)}:
            raise ParameterError(f"{group_name}.{name} is no parameter")
        changes[name] = _as_type_of(getattr(group, name), value, f"{group_name}.{name}")
    try:
        return dataclasses.replace(group, **changes)
    except ParameterError as error:
        raise ParameterError(f"{group_name}.{error}") from error


def _as_type_of(default: Any, value: Any, name: str) -> Any:
    """``value`` as the type of ``default``; integers pass as floats, lists as tuples of floats."""
    if isinstance(default, float) and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    if isinstance(default, tuple) and not isinstance(value, str):
        try:
            numbers = tuple(float(number) for number in value)
        except (TypeError, ValueError) as error:
            raise ParameterError(f"{name} = {value!r} is not a list of numbers") from error
        if len(numbers) != len(default):
            raise ParameterError(f"{name} needs {len(default)} numbers, not {len(numbers)}")
        return numbers
    if type(value) is not type(default):
        raise ParameterError(f"{name} = {value!r} is not a {type(default).__name__}")
    return value
