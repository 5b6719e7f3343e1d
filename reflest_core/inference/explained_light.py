# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light and material together: first the gloss, then the light, then both in the whole light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.gloss_fit import SURE, GlossFit, fit_gloss
from reflest_core.inference.light_from_reflections import infer_light_by_gloss
from reflest_core.inference.light_from_shading import InferredLight, infer_light
from reflest_core.inference.light_prior import BRIGHT, DIM
from reflest_core.inference.material_fit import MaterialFit, fit_material
from reflest_core.inference.transport.irradiance import (
    DARKEST,
    Incoming,
    incoming,
    weighted_radiance,
)
from reflest_core.inference.transport.light_patches import LightParts, diffuse_response
from reflest_core.inference.transport.patch_grid import patch_image
from reflest_core.inference.transport.reflected_detail import reflected_detail
from reflest_core.inference.transport.reflected_patches import reflection
from reflest_core.inference.transport.visibility import Occluders, Sight
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES, lobe_radiance
from reflest_core.light.completion import LightPyramid, complete, levels_below
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.light.light_map import ObservedLight
from reflest_core.surface.diffuse_colours import diffuse_colours
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.surface_sample import SurfaceSample, sampled
from reflest_core.surface.thinning import thinned
from reflest_core.surface.voxel_choice import choose_voxels

SHADED, SAMPLED = 512, 96
"""Voxels whose diffuse colours tell of the light; those whose observations tell of gloss."""
MOST_ALBEDO = 1.5
"""Beyond what can be, so that a fit that went astray does not lead far."""
ASKED, FITTED = 2, 2
"""Every second observation of the former tells of the light, of the latter of the material in it:
all say hardly more, and take longer."""


@dataclass(frozen=True)
class Explanation:
    """What was found, and what it was found from.

    ``filled``, ``light``: the light after pull and push alone, and as the surface completes it.
    ``incoming``: of D voxels, with ``normals`` (D, 3) and ``colours`` (D, 3), linear, without
    highlights.
    ``occluders``: what the object hides of the light.
    ``sample``: the observations that gloss was told from. ``lobes``: (Q, K, 5), the whole light in
    the lobes of those that the material was fitted to. ``inferred``: the light by the diffuse
    colours, by the observations with their gloss, and by these if unseen light is dim. ``gloss``:
    by what was seen. ``material``: by the whole light. ``detail``: see :func:`reflected_detail`.
    """

    filled: LightPyramid
    light: LightPyramid
    incoming: Incoming
    occluders: Occluders
    normals: NDArray[np.float32]
    colours: NDArray[np.float32]
    sample: SurfaceSample
    lobes: NDArray[np.float32]
    inferred: tuple[InferredLight, InferredLight, InferredLight]
    gloss: GlossFit
    material: MaterialFit
    detail: NDArray[np.float32]

    @property
    def albedos(self) -> NDArray[np.float32]:
        """(3, 3), ``rho_d`` of each channel, at most :data:`MOST_ALBEDO`.

        By the observations, by these if unseen light is dim, and by the material's fit.
        """
        _, bright, dim = self.inferred
        albedos = [bright.albedo, dim.albedo, self.material.weight @ self.material.albedo]
        return np.minimum(np.stack(albedos, axis=1), np.float32(MOST_ALBEDO))

    @property
    def glosses(self) -> NDArray[np.float32]:
        """(3,): ``rho_s`` and ``alpha`` by seen light, and ``alpha`` if observations err alone."""
        gloss, roughnesses = self.gloss, np.array(ROUGHNESSES, np.float32)
        likely, sure = gloss.weight, gloss.weight_by(SURE)
        return np.array(
            [likely @ gloss.gloss, likely @ roughnesses, sure @ roughnesses], np.float32
        )


def explain(
    surface: ObservedSurface, light: ObservedLight, has_visibility: bool = True
) -> Explanation:
    """Explain ``surface``'s colours by ``light`` where it was seen and by the least else.

    Unless it ``has_visibility``, the object hides nothing from itself (an ablation).
    """
    filled = complete(light)
    voxels = thinned(surface.observation_counts, SHADED)
    colours = diffuse_colours(surface, voxels)
    hiding = voxels if has_visibility else voxels[:0]
    occluders = Occluders.of(
        surface.positions[hiding], surface.normals[hiding], colours.mean(axis=0)
    )
    weights = cosine_weights(surface.normals[voxels])
    sight = occluders.sight(surface.positions[voxels], surface.normals[voxels], weights)
    arriving = incoming(weights, sight)
    parts = LightParts.of(light, filled)
    response = diffuse_response(parts, arriving)
    sample = sampled(surface, choose_voxels(surface, SAMPLED))
    shading = infer_light(response, colours)
    weights = cosine_weights(sample.normals)
    sight_of_sample = occluders.sight(surface.positions[sample.voxels], sample.normals, weights)
    lobes = lobe_radiance(
        filled,
        sample.normals[sample.voxel_of],
        sample.directions,
        sight_of_sample.of(sample.voxel_of),
    )
    gloss = fit_gloss(sample.colours, sample.clipped, lobes, sample.voxel_of)
    asked = sampled(surface, voxels).every(ASKED)
    mirrored = reflection(
        filled,
        gloss.roughness,
        asked.normals[asked.voxel_of],
        asked.directions,
        sight.of(asked.voxel_of),
    )
    bright, dim = infer_light_by_gloss(
        asked, response, mirrored, gloss, shading.albedo, (BRIGHT, DIM)
    )
    final = completed(light, filled, bright)
    material, lobes = _material(
        sample.every(FITTED), incoming(weights, sight_of_sample), sight_of_sample, final
    )
    detail = reflected_detail(surface, voxels)
    return Explanation(
        filled,
        final,
        arriving,
        occluders,
        surface.normals[voxels],
        colours,
        sample,
        lobes,
        (shading, bright, dim),
        gloss,
        material,
        detail,
    )


def completed(light: ObservedLight, filled: LightPyramid, found: InferredLight) -> LightPyramid:
    """The light with what the surface tells of its unseen and clipped parts."""
    fine = filled.levels[0]
    size = len(fine)
    bright = light.radiance + patch_image(found.excess, size) * filled.excess
    fill = fine[..., :3] * patch_image(found.unseen, size)
    radiance = np.where(light.coverage[..., None] > 0.0, bright, fill)
    finest = np.concatenate([radiance, fine[..., 3:]], axis=-1).astype(np.float32)
    return levels_below(finest, filled.excess)


def _material(
    sample: SurfaceSample, arriving: Incoming, sight: Sight, light: LightPyramid
) -> tuple[MaterialFit, NDArray[np.float32]]:
    diffuse = np.maximum(weighted_radiance(light, arriving)[:, :3], DARKEST)
    lobes = lobe_radiance(
        light, sample.normals[sample.voxel_of], sample.directions, sight.of(sample.voxel_of)
    )
    of_observation = diffuse[sample.voxel_of]
    brightness = np.minimum(of_observation / np.maximum(diffuse.mean(axis=0), DARKEST), 1.0)
    fit = fit_material(
        np.asarray(sample.colours / of_observation, np.float32),
        np.asarray(lobes[..., :3] / of_observation[:, None], np.float32),
        np.where(sample.clipped, np.float32(0.0), brightness),
    )
    return fit, lobes
