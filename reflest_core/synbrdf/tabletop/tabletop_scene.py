# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scene of many materials before it is rendered: everything that its seed decides."""

from __future__ import annotations

import dataclasses
import enum
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters
from reflest_core.synbrdf.lights.environments import (
    load_environment,
    load_environments,
    rotated,
)
from reflest_core.synbrdf.lights.light_diversity import draw_diverse_light
from reflest_core.synbrdf.room.draw import draw_room
from reflest_core.synbrdf.room.geometry import Room
from reflest_core.synbrdf.scenes.material_sources import Materials, NamedMaterial
from reflest_core.synbrdf.scenes.painted_mesh import PaintedMesh, joined
from reflest_core.synbrdf.scenes.scene import DIVERSE, ROOM, Light, Scene
from reflest_core.synbrdf.scenes.seeding import Purpose, generator
from reflest_core.synbrdf.scenes.splits import Sources, Split
from reflest_core.synbrdf.sequences.trajectory import Orbit, hand_held_orbit
from reflest_core.synbrdf.tabletop.ground import Setting, draw_ground
from reflest_core.synbrdf.tabletop.objects import ChosenObject, draw_objects

CORNER_SHARE, ROOM_SHARE = 0.25, 0.3
"""Of scenes where the user leaves setting and lighting open."""
ORBITS = {
    Setting.TABLE: Orbit((0.55, 0.9), (22.0, 65.0), (240.0, 380.0)),
    Setting.CORNER: Orbit((0.55, 0.9), (20.0, 55.0), (70.0, 110.0), middle=225.0),
}
SPARSE_HEIGHT = 128
"""Rows of the environment map of observation scenes."""
AIM_DIAMETER = 0.4
"""Metres of the middle of the ground that the camera's aim wanders over."""


class TabletopLight(enum.Enum):
    """Where light comes from."""

    DISTANT = "distant"
    """An environment map, infinitely far."""
    DIVERSE = "diverse"
    """The same of a new one, mixed of the given ones, procedural skies and rooms; for training."""
    NEAR = "near"
    """A room of :mod:`.room.draw`, whose windows show an environment map."""


@dataclass(frozen=True)
class TabletopChoices:
    """What a user decides; None leaves it to the seed.

    Attributes:
        setting: What objects stand on.
        light: Where light comes from.
        environment_height: Rows of the environment map.
        ground: Material of the table, which then has no pattern.
        objects: What stands on it; empty leaves it to the seed.
    """

    setting: Setting | None = None
    light: TabletopLight | None = None
    environment_height: int = 256
    ground: WardParameters | None = None
    objects: tuple[ChosenObject, ...] = ()


@dataclass(frozen=True)
class TabletopScene:
    """Objects of several materials on a ground, under one light, and the cameras that see them.

    Attributes:
        setting: What objects stand on.
        painted: Objects and ground; the ground is at z = 0 with its middle at the origin.
        shapes: Name of each object's shape.
        light: The environment map; in a room what its windows show.
        room: What stands about the ground; None under distant light.
        poses: ``T_world_camera`` (W, 4, 4), optical frames.
    """

    setting: Setting
    painted: PaintedMesh
    shapes: list[str]
    light: Light
    room: Room | None
    poses: NDArray[np.float64]


def draw_tabletop(
    rng: np.random.Generator,
    sources: Sources,
    materials: Materials,
    views: int,
    choices: TabletopChoices,
) -> TabletopScene:
    """Draw a scene; the same arguments give the same one.

    Args:
        rng: Source of the draw.
        sources: Environments and meshes.
        materials: What to draw materials from.
        views: Poses of the camera.
        choices: What is not left to ``rng``; the rest of the scene does not depend on it.
    """
    of_setting, of_ground, of_objects, of_light, of_room, of_views = rng.spawn(6)
    in_corner, in_room = of_setting.uniform(size=2) < [CORNER_SHARE, ROOM_SHARE]
    drawn = Setting.CORNER if in_corner and choices.ground is None else Setting.TABLE
    setting = choices.setting or drawn
    near = TabletopLight.NEAR if in_room else TabletopLight.DISTANT
    is_near = (choices.light or near) is TabletopLight.NEAR
    chosen = None if choices.ground is None else NamedMaterial.given(choices.ground)
    ground = draw_ground(of_ground, setting, materials, chosen)
    objects, shapes = draw_objects(of_objects, sources.meshes, materials, choices.objects)
    painted = joined([ground, *objects])
    poses = hand_held_orbit(of_views, views, AIM_DIAMETER, ORBITS[setting])
    if choices.light is TabletopLight.DIVERSE:
        light = _draw_diverse_light(of_light, sources)
    else:
        light = _draw_light(of_light, sources, choices.environment_height)
    room = None
    if is_near:
        room = draw_room(of_room, painted.mesh, poses, light.radiance, has_table=False)
        light = dataclasses.replace(light, name=f"{ROOM}+{light.name}" if room.windows else ROOM)
    return TabletopScene(setting, painted, shapes, light, room, poses)


def draw_tabletop_scene(
    seed: int,
    split: Split,
    index: int,
    sources: Sources,
    views: int,
    materials: Materials,
    is_near: bool,
) -> Scene:
    """Draw an observation scene; the same arguments give the same one.

    Args:
        seed: Of the data set.
        split: Train, validation or unseen.
        index: Within the split.
        sources: Environments and meshes of the split.
        views: Cameras.
        materials: What the split's materials are drawn from.
        is_near: Whether all scenes stand in rooms; else as the seed decides.
    """
    rng = generator(seed, split, index, Purpose.DRAW_TABLETOP)
    light = TabletopLight.NEAR if is_near else None
    choices = TabletopChoices(light=light, environment_height=SPARSE_HEIGHT)
    drawn = draw_tabletop(rng, sources, materials, views, choices)
    return Scene(
        split=split,
        index=index,
        shape="+".join(drawn.shapes),
        painted=drawn.painted,
        light=drawn.light,
        poses=drawn.poses,
        view_pattern=drawn.setting.value,
        room=drawn.room,
    )


def _draw_light(rng: np.random.Generator, sources: Sources, height: int) -> Light:
    source = sources.environments[int(rng.integers(len(sources.environments)))]
    angle = float(rng.uniform(0.0, 2.0 * np.pi))
    return Light(source.name, angle, rotated(load_environment(source, height), angle))


def _draw_diverse_light(rng: np.random.Generator, sources: Sources) -> Light:
    drawn = draw_diverse_light(rng, load_environments(sources.environments))
    return Light("+".join((DIVERSE, *drawn.natural)), 0.0, drawn.radiance)
