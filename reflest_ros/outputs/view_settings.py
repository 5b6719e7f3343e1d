# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the topics for displays."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar, cast

from rclpy.node import Node

from reflest_core.environment.environment_map import HEIGHT
from reflest_core.estimation.settings import with_values
from reflest_core.fusion.snapshot import MOST_VOXELS
from reflest_core.parameter import check_parameters, parameter
from reflest_core.rendering.voxel_colours import VoxelColouring

Settings = TypeVar("Settings")

MOST_KEYFRAMES = 1000
"""Poses that the markers remember."""


@dataclass(frozen=True)
class PreviewSettings:
    """The sphere on ``reflectance/preview``."""

    size: int = parameter(
        256, "Edge of the picture of the sphere.", unit="pixels", minimum=32, maximum=512
    )

    def __post_init__(self) -> None:
        check_parameters(self)


@dataclass(frozen=True)
class VoxelSettings:
    """The point cloud on ``reflectance/voxels``."""

    colour: str = parameter(
        VoxelColouring.OBSERVED.value,
        "Colour of the points: observed (mean of what the camera saw), views (how many views saw "
        "the voxel, dark to light) or estimate (the estimated material, lit from the keyframe).",
        choices=tuple(one.value for one in VoxelColouring),
    )
    max_points: int = parameter(
        MOST_VOXELS,
        "Most points in the cloud; a larger one is thinned evenly.",
        minimum=100,
        maximum=MOST_VOXELS,
    )

    def __post_init__(self) -> None:
        check_parameters(self)


@dataclass(frozen=True)
class EnvironmentSettings:
    """The images on ``reflectance/environment``."""

    height: int = parameter(
        HEIGHT,
        "Rows of the images of the light around the object; they are twice as wide.",
        unit="pixels",
        minimum=16,
        maximum=512,
    )

    def __post_init__(self) -> None:
        check_parameters(self)


@dataclass(frozen=True)
class MarkerSettings:
    """The markers on ``reflectance/markers``."""

    max_keyframes: int = parameter(
        200, "Most keyframes drawn; the newest ones.", minimum=0, maximum=MOST_KEYFRAMES
    )
    frustum: float = parameter(
        0.05,
        "Length of the pyramid drawn for a keyframe's camera.",
        unit="m",
        minimum=0.001,
        maximum=10.0,
    )

    def __post_init__(self) -> None:
        check_parameters(self)


@dataclass(frozen=True)
class MaterialSettings:
    """The materials of the whole scan, on ``reflectance/materials`` and its views."""

    when: str = parameter(
        "subscribed",
        "When materials are estimated: at keyframes while someone subscribes to one of their "
        "topics, always at keyframes, or never.",
        choices=("subscribed", "always", "never"),
    )

    def __post_init__(self) -> None:
        check_parameters(self)


def read_settings(node: Node, group: str, kind: Callable[[], Settings]) -> Settings:
    """Read a group of parameters as it is set now.

    Args:
        node: It has declared the parameters.
        group: Name of the group.
        kind: The dataclass of its settings.

    Returns:
        The settings.
    """
    settings = kind()
    names = [field.name for field in dataclasses.fields(cast(Any, settings))]
    values = {name: node.get_parameter(f"{group}.{name}").value for name in names}
    return cast(Settings, with_values(settings, values, group))
