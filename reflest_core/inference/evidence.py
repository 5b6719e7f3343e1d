# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the observations of one material show of its gloss and of the light that falls on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.gloss.gloss_fit import GlossFit, fit_gloss
from reflest_core.inference.transport.irradiance import Incoming, incoming
from reflest_core.inference.transport.scene_occluders import SceneOccluders
from reflest_core.inference.transport.visibility import Occluders, Sight
from reflest_core.inference.transport.ward_lobe import lobe_radiance
from reflest_core.light.completion import LightPyramid
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.surface.diffuse_colours import diffuse_colours
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.surface_sample import SurfaceSample, sampled
from reflest_core.surface.thinning import thinned
from reflest_core.surface.voxel_choice import choose_voxels

SHADED, SAMPLED = 512, 384
"""Voxels whose diffuse colours the light is inferred from; those whose observations give gloss."""
TRAINED = 96
"""Voxels whose observations gave gloss when lightnet was trained."""


@dataclass(frozen=True)
class DiffuseSample:
    """Voxels spread over a surface.

    Attributes:
        voxels: (D,) indices into it.
        colours: (D, 3) float32, linear, without highlights.
    """

    voxels: NDArray[np.int64]
    colours: NDArray[np.float32]

    @staticmethod
    def of(surface: ObservedSurface) -> DiffuseSample:
        """Choose voxels evenly.

        Args:
            surface: A whole scan, or a material's part of it.
        """
        voxels = thinned(surface.observation_counts, SHADED)
        return DiffuseSample(voxels, diffuse_colours(surface, voxels))


@dataclass(frozen=True)
class MaterialEvidence:
    """Observations of one material's surface beside the light that was seen.

    Attributes:
        surface: the material's part of the scan.
        voxels: (D,) indices into it, spread over it; their diffuse colours show the light.
        colours: (D, 3) float32, linear, without highlights.
        sight: what the D voxels see of the light past the scene's surfaces.
        incoming: from where light comes to the D voxels.
        sample: the observations that the gloss is fitted to.
        sight_of_sample: the sight of the sample's voxels.
        incoming_of_sample: the same as ``incoming`` of the sample's voxels.
        gloss: fitted under the light that was seen.
    """

    surface: ObservedSurface
    voxels: NDArray[np.int64]
    colours: NDArray[np.float32]
    sight: Sight
    incoming: Incoming
    sample: SurfaceSample
    sight_of_sample: Sight
    incoming_of_sample: Incoming
    gloss: GlossFit


def scene_occluders(
    surface: ObservedSurface, has_visibility: bool = True, diffuse: DiffuseSample | None = None
) -> Occluders:
    """Surfels of a whole scan that hide light from one another.

    Args:
        surface: all materials together.
        has_visibility: False for none (an ablation); their mean colour is then still that of the
            surface.
        diffuse: of the surface, where it is known.
    """
    diffuse = DiffuseSample.of(surface) if diffuse is None else diffuse
    hiding = diffuse.voxels if has_visibility else diffuse.voxels[:0]
    own = diffuse.colours.mean(axis=0)
    return Occluders.of(surface.positions[hiding], surface.normals[hiding], own)


def material_evidence(
    surface: ObservedSurface,
    filled: LightPyramid,
    occluders: Occluders | SceneOccluders,
    share: float = 1.0,
    diffuse: DiffuseSample | None = None,
) -> MaterialEvidence:
    """Gather the evidence of one material.

    Args:
        surface: the material's voxels, of which at least one was observed.
        filled: the light that was seen, filled smoothly where it was not.
        occluders: of the whole scene.
        share: of the usual voxels whose observations give gloss, in (0, 1].
        diffuse: of the material's voxels, where it is known.
    """
    diffuse = DiffuseSample.of(surface) if diffuse is None else diffuse
    voxels = diffuse.voxels
    weights = cosine_weights(surface.normals[voxels])
    sight = occluders.sight(surface.positions[voxels], surface.normals[voxels], weights)
    sample = sampled(surface, choose_voxels(surface, max(round(share * SAMPLED), TRAINED)))
    weights_of_sample = cosine_weights(sample.normals)
    sight_of_sample = occluders.sight(
        surface.positions[sample.voxels], sample.normals, weights_of_sample
    )
    lobes = lobe_radiance(
        filled,
        sample.normals[sample.voxel_of],
        sample.directions,
        sight_of_sample.of(sample.voxel_of),
    )
    gloss = fit_gloss(sample.colours, sample.clipped, lobes, sample.voxel_of)
    return MaterialEvidence(
        surface=surface,
        voxels=voxels,
        colours=diffuse.colours,
        sight=sight,
        incoming=incoming(weights, sight),
        sample=sample,
        sight_of_sample=sight_of_sample,
        incoming_of_sample=incoming(weights_of_sample, sight_of_sample),
        gloss=gloss.tempered(max(len(sample.voxels) / TRAINED, 1.0)),
    )
