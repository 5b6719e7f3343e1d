# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A SynBRDF scene of another material under another light, without rendering it again.

Shapes and cameras are the scene's; every observation becomes what Eq. 1 (the paper, Sec. 3) says
of the new material in the new light. So a network meets far more lights than could be rendered.
Eq. 1 knows neither shadows that an object casts on itself nor light between its parts: only
objects that hide next to nothing of the light are relit.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters
from reflest_core.inference.transport.irradiance import incoming
from reflest_core.inference.transport.visibility import Occluders
from reflest_core.inference.transport.ward_lobe import reflected
from reflest_core.light import rgbe
from reflest_core.light.completion import RADIANCE, LightPyramid, levels_below
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.light.equirectangular import radiance_from
from reflest_core.light.octahedral import (
    octahedral_directions,
    octahedral_solid_angles,
    octahedral_texels,
)
from reflest_core.synbrdf.lights.environments import rotated
from reflest_core.synbrdf.lights.light_diversity import DiverseLight, draw_diverse_light
from reflest_core.synbrdf.relit.scene_light import background_directions
from reflest_core.synbrdf.scenes.exposure import auto_exposure, expose
from reflest_core.synbrdf.scenes.materials import draw_material
from reflest_core.synbrdf.scenes.metering import mean_colours
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.synbrdf.scenes.scene_materials import SceneMaterial, VoxelMaterials

EDGE = 192
"""Of the octahedral map that reflections look into: 0.9 degrees a texel."""
NATURAL_SHARE = 0.5
"""Of the lights are one environment as it is, turned, unless asked for otherwise; the others are as
diverse light is drawn."""
TINT_STDDEV = 0.12
"""Of the logarithm of each channel of a natural light."""
MOST_HIDDEN = 0.03
"""Share of the light, weighted by cosine, that an object may hide from its own surface."""
NAME = "relit"
"""Names relit light; the environments in it follow, each after a "+"."""


def is_relightable(scene: SynbrdfScene) -> bool:
    """Whether Eq. 1 holds: light from infinitely far, next to nothing of it hidden.

    Args:
        scene: the scene.
    """
    if scene.thumbnails.depth is not None:
        return False
    surface = scene.surface
    occluders = Occluders.of(surface.positions, surface.normals, np.zeros(3, np.float32))
    weights = cosine_weights(surface.normals)
    sight = occluders.sight(surface.positions, surface.normals, weights)
    return float(incoming(weights, sight).hidden.mean()) <= MOST_HIDDEN


def randomly_relit(
    scene: SynbrdfScene,
    maps: Mapping[str, NDArray[np.float32]],
    rng: np.random.Generator,
    natural_share: float = NATURAL_SHARE,
) -> SynbrdfScene:
    """Draw another material and another light for a scene.

    Args:
        scene: a relightable scene.
        maps: (H, 2 H, 3) linear radiance of environments by name.
        rng: random numbers; the same state draws the same.
        natural_share: share of scenes under unmixed environments.
    """
    if rng.uniform() < natural_share:
        name = list(maps)[int(rng.integers(len(maps)))]
        light = rotated(maps[name], float(rng.uniform(0.0, 2.0 * np.pi)))
        light = light * np.exp(rng.normal(0.0, TINT_STDDEV, 3)).astype(np.float32)
        drawn = DiverseLight(light, (name,))
    else:
        drawn = draw_diverse_light(rng, maps)
    again = relit(
        scene, draw_material(rng, scene.materials.dominant.ward.variant), drawn.radiance, rng
    )
    return dataclasses.replace(again, environment="+".join((NAME, *drawn.natural)))


def relit(
    scene: SynbrdfScene,
    material: WardParameters,
    environment: NDArray[np.float32],
    rng: np.random.Generator,
) -> SynbrdfScene:
    """Give a scene another material and another light.

    Args:
        scene: a relightable scene.
        material: Ward parameters.
        environment: (H, 2 H, 3) linear radiance, equirectangular, z up.
        rng: draws which of a view's observations stand for the object's pixels in its thumbnail.
    """
    surface, thumbnails = scene.surface, scene.thumbnails
    light = _pyramid(environment)
    radiance = _radiance(scene, material, light)
    directions = background_directions(thumbnails, surface.positions.mean(axis=0))
    images = light.levels[0][..., RADIANCE].reshape(-1, 3)[octahedral_texels(directions, EDGE)]
    on_object = _as_pixels(radiance, surface.view_indices, thumbnails.is_object, rng)
    images[thumbnails.is_object] = on_object
    exposure = auto_exposure(images)
    by_view = (len(images), -1)
    foreground, background = mean_colours(
        expose(images, exposure).reshape(*by_view, 3), thumbnails.is_object.reshape(by_view)
    )
    return dataclasses.replace(
        scene,
        materials=VoxelMaterials.uniform(SceneMaterial(material), surface.voxel_count),
        environment=NAME,
        environment_rotation=0.0,
        exposure=exposure,
        radiance=radiance.astype(np.float16),
        thumbnails=dataclasses.replace(thumbnails, rgbe=rgbe.encode(images)),
        surface=dataclasses.replace(
            surface,
            colours=expose(radiance, exposure),
            view_foreground=foreground,
            view_background=background,
        ),
    )


def _pyramid(environment: NDArray[np.float32]) -> LightPyramid:
    """All of it seen, nothing clipped; brought to a mean of 1, for half floats hold its colours."""
    directions = octahedral_directions(EDGE).reshape(-1, 3)
    radiance = radiance_from(environment / environment.mean(), directions).reshape(EDGE, EDGE, 3)
    known = np.broadcast_to(np.array([1.0, 0.0], np.float32), (EDGE, EDGE, 2))
    return levels_below(np.concatenate([radiance, known], axis=-1))


def _radiance(
    scene: SynbrdfScene, material: WardParameters, light: LightPyramid
) -> NDArray[np.float32]:
    """(O, 3) of every observation by Eq. 1."""
    surface = scene.surface
    voxel_of = np.repeat(np.arange(surface.voxel_count), surface.observation_counts)
    diffuse = _diffuse(light.levels[1], surface.normals)[voxel_of]
    gloss = reflected(light, material.alpha, surface.normals[voxel_of], surface.view_directions())
    albedo = np.asarray(material.rho_d, np.float32)
    return albedo * diffuse + np.float32(material.rho_s) * gloss


def _diffuse(level: NDArray[np.float32], normals: NDArray[np.float32]) -> NDArray[np.float32]:
    """(V, 3) ``E(n) / pi``, from a finer map than while scanning: a small sun has a hard edge."""
    edge = len(level)
    directions = octahedral_directions(edge).reshape(-1, 3)
    weights = np.maximum(normals @ directions.T, 0.0) * octahedral_solid_angles(edge).reshape(-1)
    return np.asarray(weights @ level[..., RADIANCE].reshape(-1, 3) / np.float32(np.pi), np.float32)


def _as_pixels(
    radiance: NDArray[np.float32],
    view_indices: NDArray[np.uint16],
    is_object: NDArray[np.bool_],
    rng: np.random.Generator,
) -> NDArray[np.float32]:
    """(P, 3) for the P pixels of the object: random observations of the same view."""
    view_of = np.repeat(np.arange(len(is_object)), is_object.reshape(len(is_object), -1).sum(1))
    by_view = np.argsort(view_indices, kind="stable")
    counts = np.bincount(view_indices, minlength=len(is_object))
    starts = np.cumsum(counts) - counts
    drawn = (rng.random(len(view_of)) * counts[view_of]).astype(np.int64)
    anything = rng.integers(len(radiance), size=len(view_of))
    chosen = np.where(
        counts[view_of] > 0,
        by_view[np.minimum(starts[view_of] + drawn, len(by_view) - 1)],
        anything,
    )
    return radiance[chosen]
