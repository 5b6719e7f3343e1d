# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A SynBRDF scene before it is rendered: everything that its seed decides."""

from __future__ import annotations

import dataclasses
import enum
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.lights.environments import load_environment, load_environments, rotated
from reflest_core.synbrdf.lights.light_diversity import draw_diverse_light
from reflest_core.synbrdf.room.draw import draw_room
from reflest_core.synbrdf.room.geometry import Room
from reflest_core.synbrdf.scenes.material_sources import OPENSURFACES, Materials
from reflest_core.synbrdf.scenes.painted_mesh import PaintedMesh
from reflest_core.synbrdf.scenes.scene_materials import SceneMaterial
from reflest_core.synbrdf.scenes.seeding import Purpose, generator
from reflest_core.synbrdf.scenes.splits import Sources, Split
from reflest_core.synbrdf.scenes.views import draw_views
from reflest_core.synbrdf.shapes.mesh import TriangleMesh
from reflest_core.synbrdf.shapes.mesh_file import load_mesh
from reflest_core.synbrdf.shapes.procedural import DIAMETERS, draw_procedural, draw_rotation

MESH_SHARE = 0.3
"""Of the scenes show a mesh from a file, where there are any; the rest are procedural."""
BLEND_SHARE = 0.3
"""Of the training scenes stand in a blend of two environments."""
TINT_STDDEV = 0.12
"""Of the logarithm of each channel's tint in training scenes."""
DIVERSE = "diverse"
"""Names diverse light; the environments in it follow, each after a "+"."""
ROOM = "room"
"""Names the light of a room; what its windows show follows after a "+"."""


@dataclass(frozen=True)
class Light:
    """Light from infinitely far.

    Attributes:
        name: Its source, or sources joined by ``+``.
        rotation: Radians about the vertical.
        radiance: (H, 2 H, 3) float32, linear sRGB, equirectangular, z up.
    """

    name: str
    rotation: float
    radiance: NDArray[np.float32]


@dataclass(frozen=True)
class Scene:
    """Surfaces under one light, and the cameras that see them.

    Attributes:
        split: Train, validation or unseen.
        index: Within the split.
        shape: Name of the shape, or names joined by ``+``.
        painted: All surfaces that have a truth, and their materials.
        light: The environment; in a room what its windows show.
        poses: ``T_world_camera`` (W, 4, 4), optical frames.
        view_pattern: How the views are spread.
        room: What stands about the object; None where the light is infinitely far on all sides.
    """

    split: Split
    index: int
    shape: str
    painted: PaintedMesh
    light: Light
    poses: NDArray[np.float64]
    view_pattern: str
    room: Room | None = None

    @property
    def mesh(self) -> TriangleMesh:
        """All surfaces that have a truth."""
        return self.painted.mesh


class Lighting(enum.Enum):
    """Where scenes take their light from; with diverse light validation and unseen stay natural."""

    NATURAL = "natural"
    """An environment or a blend of two, slightly tinted."""
    DIVERSE = "diverse"
    """As :mod:`.light_diversity` draws it: mixtures, rooms, skies, lamps."""
    NEAR = "near"
    """In rooms (:mod:`.room.draw`) a few metres across; in all splits."""


def draw_scene(
    seed: int,
    split: Split,
    index: int,
    sources: Sources,
    views: int,
    lighting: Lighting = Lighting.NATURAL,
    materials: Materials = OPENSURFACES,
) -> Scene:
    """Draw a scene of one object; the same arguments give the same scene.

    Args:
        seed: Of the data set.
        split: Train, validation or unseen.
        index: Within the split.
        sources: Environments and meshes of the split.
        views: Cameras.
        lighting: Where light comes from.
        materials: What the material is drawn from.
    """
    is_diverse = lighting is Lighting.DIVERSE and split is Split.TRAIN
    is_near = lighting is Lighting.NEAR
    purpose = Purpose.DRAW_DIVERSE if is_diverse else Purpose.DRAW
    rng = generator(seed, split, index, Purpose.DRAW_NEAR if is_near else purpose)
    material = materials.draw(rng)
    mesh, shape = _draw_shape(rng, sources)
    if is_diverse:
        drawn = draw_diverse_light(rng, load_environments(sources.environments))
        light = Light("+".join((DIVERSE, *drawn.natural)), 0.0, drawn.radiance)
    else:
        light = _draw_light(rng, sources, vary=split is Split.TRAIN)
    poses, pattern = draw_views(rng, views, mesh.diameter)
    room = draw_room(rng, mesh, poses, light.radiance) if is_near else None
    if room is not None:
        name = f"{ROOM}+{light.name}" if room.windows else ROOM
        light = dataclasses.replace(light, name=name)
    return Scene(
        split=split,
        index=index,
        shape=shape,
        painted=PaintedMesh.uniform(mesh, SceneMaterial.of(material)),
        light=light,
        poses=poses,
        view_pattern=pattern.value,
        room=room,
    )


def _draw_shape(rng: np.random.Generator, sources: Sources) -> tuple[TriangleMesh, str]:
    from_file = len(sources.meshes) > 0 and rng.uniform() < MESH_SHARE
    if from_file:
        source = sources.meshes[int(rng.integers(len(sources.meshes)))]
        mesh, name = load_mesh(source), source.name
    else:
        mesh, name = draw_procedural(rng)
    rotation = draw_rotation(rng, upright=from_file)
    return mesh.moved(rotation, float(rng.uniform(*DIAMETERS))), name


def _draw_light(rng: np.random.Generator, sources: Sources, vary: bool) -> Light:
    light = _one_light(rng, sources)
    if not vary:
        return light
    if rng.uniform() < BLEND_SHARE:
        other = _one_light(rng, sources)
        share = np.float32(rng.uniform(0.2, 0.8))
        scale = light.radiance.mean() / other.radiance.mean()
        blended = share * light.radiance + (1 - share) * scale * other.radiance
        light = Light(f"{light.name}+{other.name}", light.rotation, blended)
    tint = np.exp(rng.normal(0.0, TINT_STDDEV, 3)).astype(np.float32)
    return dataclasses.replace(light, radiance=light.radiance * tint)


def _one_light(rng: np.random.Generator, sources: Sources) -> Light:
    source = sources.environments[int(rng.integers(len(sources.environments)))]
    angle = float(rng.uniform(0.0, 2 * np.pi))
    return Light(source.name, angle, rotated(load_environment(source), angle))
