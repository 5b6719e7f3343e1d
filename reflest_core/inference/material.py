# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One material in the light of its scene: albedo and gloss that explain its observations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.evidence import MaterialEvidence
from reflest_core.inference.gloss.gloss_fit import SURE, GlossFit
from reflest_core.inference.gloss.posterior import GlossPosterior
from reflest_core.inference.light import Inferences, SceneLight, infer_light
from reflest_core.inference.material_fit import MaterialFit, fit_material
from reflest_core.inference.transport.irradiance import DARKEST, Incoming, weighted_radiance
from reflest_core.inference.transport.reflected_detail import reflected_detail
from reflest_core.inference.transport.scene_occluders import SceneOccluders
from reflest_core.inference.transport.visibility import Occluders
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES, lobe_radiance
from reflest_core.light.completion import RADIANCE, LightPyramid
from reflest_core.light.light_map import ObservedLight
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.partition import WHOLE
from reflest_core.surface.surface_sample import SurfaceSample

MOST_ALBEDO = 1.5
"""Beyond what can be, so that a fit that went astray does not lead far."""
FITTED = 4
"""Every fourth observation of the sample is fitted: all give hardly more, and take longer."""


@dataclass(frozen=True)
class Explanation:
    """A material and the light it was seen in, with what they were inferred from.

    Attributes:
        surface: the material's part of the scan.
        filled: the light that was seen, filled smoothly.
        light: the completed light.
        incoming: from where light comes to D voxels.
        occluders: surfels of the scene that hide light.
        normals: (D, 3) float32, of the D voxels.
        colours: (D, 3) float32, linear, without highlights.
        sample: the observations that gloss is fitted to.
        lobes: (Q, K, 5) float32, the completed light in the lobes of those that the material is
            fitted to, see :func:`~.ward_lobe.lobe_radiance`.
        inferred: the light by diffuse colours, by observations with gloss, by these if it is dim.
        gloss: fitted under the light that was seen.
        material: fitted under the completed light.
        detail: see :func:`~.reflected_detail.reflected_detail`.
        posterior: of the material's roughness; None where it was not asked for.
    """

    surface: ObservedSurface
    filled: LightPyramid
    light: LightPyramid
    incoming: Incoming
    occluders: Occluders | SceneOccluders
    normals: NDArray[np.float32]
    colours: NDArray[np.float32]
    sample: SurfaceSample
    lobes: NDArray[np.float32]
    inferred: Inferences
    gloss: GlossFit
    material: MaterialFit
    detail: NDArray[np.float32]
    posterior: GlossPosterior | None = None

    @property
    def albedos(self) -> NDArray[np.float32]:
        """(3, 3) ``rho_d`` of each channel, at most :data:`MOST_ALBEDO`.

        The columns: by the observations, by these if unseen light is dim, by the material's fit.
        """
        _, bright, dim = self.inferred
        albedos = [bright.albedo, dim.albedo, self.material.weight @ self.material.albedo]
        return np.minimum(np.stack(albedos, axis=1), np.float32(MOST_ALBEDO))

    @property
    def glosses(self) -> NDArray[np.float32]:
        """(3,) ``rho_s`` and ``alpha`` by seen light, and ``alpha`` if errors are independent."""
        gloss, roughnesses = self.gloss, np.array(ROUGHNESSES, np.float32)
        likely, sure = gloss.weight, gloss.weight_by(SURE)
        return np.array(
            [likely @ gloss.gloss, likely @ roughnesses, sure @ roughnesses], np.float32
        )


def explain(
    surface: ObservedSurface, light: ObservedLight, has_visibility: bool = True
) -> Explanation:
    """Explain a surface of one material by the light that was seen and by the least else.

    Args:
        surface: at least one voxel was observed.
        light: what the background showed.
        has_visibility: see :func:`~.light.infer_light`.
    """
    return explain_material(infer_light(surface, light, has_visibility=has_visibility), WHOLE)


def explain_material(light: SceneLight, material_id: int) -> Explanation:
    """Fit one material of a scene under its completed light.

    Args:
        light: inferred from a partition that holds the material.
        material_id: which one; KeyError where the light has no evidence of it.
    """
    evidence = light.evidence[material_id]
    material, lobes = _fitted(evidence, light.completed)
    return Explanation(
        surface=evidence.surface,
        filled=light.filled,
        light=light.completed,
        incoming=evidence.incoming,
        occluders=light.occluders,
        normals=evidence.surface.normals[evidence.voxels],
        colours=evidence.colours,
        sample=evidence.sample,
        lobes=lobes,
        inferred=light.inferred[material_id],
        gloss=evidence.gloss,
        material=material,
        detail=reflected_detail(evidence.surface, evidence.voxels),
    )


def _fitted(
    evidence: MaterialEvidence, light: LightPyramid
) -> tuple[MaterialFit, NDArray[np.float32]]:
    sample, sight = evidence.sample.every(FITTED), evidence.sight_of_sample
    diffuse = np.maximum(
        weighted_radiance(light, evidence.incoming_of_sample)[:, RADIANCE], DARKEST
    )
    lobes = lobe_radiance(
        light, sample.normals[sample.voxel_of], sample.directions, sight.of(sample.voxel_of)
    )
    of_observation = diffuse[sample.voxel_of]
    brightness = np.minimum(of_observation / np.maximum(diffuse.mean(axis=0), DARKEST), 1.0)
    fit = fit_material(
        np.asarray(sample.colours / of_observation, np.float32),
        np.asarray(lobes[..., RADIANCE] / of_observation[:, None], np.float32),
        np.where(sample.clipped, np.float32(0.0), brightness),
    )
    return fit, lobes
