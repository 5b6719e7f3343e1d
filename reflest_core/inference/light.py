# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light of a scene: what was seen of it, completed by what all materials reflect."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.inference.evidence import (
    DiffuseSample,
    MaterialEvidence,
    material_evidence,
    scene_occluders,
)
from reflest_core.inference.joint_scene import JointScene, infer_jointly
from reflest_core.inference.light_from_reflections import infer_light_by_gloss
from reflest_core.inference.light_from_shading import InferredLight, infer_from_shading
from reflest_core.inference.light_prior import BRIGHT, DIM
from reflest_core.inference.transport.light_patches import (
    LightParts,
    PatchResponse,
    completed_light,
    diffuse_response,
)
from reflest_core.inference.transport.reflected_patches import reflection
from reflest_core.inference.transport.scene_occluders import SceneOccluders
from reflest_core.inference.transport.visibility import Occluders
from reflest_core.light.completion import LightPyramid, complete
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.partition import UNASSIGNED, Partition
from reflest_core.surface.surface_sample import sampled

USED_OBSERVATIONS = 2
"""Every second observation of the shaded voxels enters: all give hardly more, and take longer."""
SETS, SMALLEST_SET = 2, 64
"""Sets of the shaded voxels that the light is inferred from one by one, and voxels of the least."""
USUAL_ALBEDO = 0.25
"""Mean diffuse albedo of SynBRDF's materials."""
ASSUMED_COVERAGE = 1e-3
"""Above 0, so that the assumed radiance counts; far below what any background shows."""

Inferences = tuple[InferredLight, InferredLight, InferredLight]
"""The light by diffuse colours, by observations with gloss, and by these with a dim prior."""


@dataclass(frozen=True)
class SceneLight:
    """The light of a scene and what it was inferred from.

    Attributes:
        observed: what the background showed.
        filled: that light, filled smoothly where it was not seen.
        completed: that light with unseen and clipped parts as the materials' colours need them.
        occluders: surfels of the scene that hide light from one another.
        evidence: what each material's observations show, by material id.
        inferred: the light that each material's observations give, by material id; of several
            materials the light that all of them give, with each one's albedo.
        joint: the segments that the light of several materials was inferred from; None for one.
    """

    observed: ObservedLight
    filled: LightPyramid
    completed: LightPyramid
    occluders: Occluders | SceneOccluders
    evidence: Mapping[int, MaterialEvidence]
    inferred: Mapping[int, Inferences]
    joint: JointScene | None = None


def infer_light(
    surface: ObservedSurface,
    observed: ObservedLight,
    partition: Partition | None = None,
    has_visibility: bool = True,
    joint: JointScene | None = None,
    evidence_of: Collection[int] | None = None,
    evidence_share: float = 1.0,
) -> SceneLight:
    """Infer the light of a scene from the light that was seen and from all materials.

    Args:
        surface: the scan, of which at least one voxel was observed.
        observed: what the background showed of the light.
        partition: voxels to materials; None takes the whole surface for one material.
        has_visibility: False takes the surface for convex, so that it hides nothing (an ablation of
            one material).
        joint: the light of the surface's segments, where it is known already; None takes each of
            several materials for a segment.
        evidence_of: those of several materials whose evidence is gathered; None for all.
        evidence_share: of one material's usual evidence, in (0, 1]: less takes less time.
    """
    partition = Partition.whole(surface) if partition is None else partition
    if joint is not None or len(partition.ids) > 1:
        return _infer_jointly(surface, observed, partition, joint, evidence_of)
    filled = complete(observed)
    parts = LightParts.of(observed, filled)
    diffuse = DiffuseSample.of(surface)
    occluders = scene_occluders(surface, has_visibility, diffuse)
    evidence = {
        material_id: material_evidence(
            part, filled, occluders, evidence_share, diffuse if part is surface else None
        )
        for material_id, part in partition.parts(surface)
        if part.observation_counts.any()
    }
    inferred = {
        material_id: _inferred(found, filled, parts, evidence_share)
        for material_id, found in evidence.items()
    }
    (found,) = inferred.values()
    _, bright, _ = found
    completed = completed_light(observed, filled, bright.unseen, bright.excess)
    return SceneLight(observed, filled, completed, occluders, evidence, inferred)


def _infer_jointly(
    surface: ObservedSurface,
    observed: ObservedLight,
    partition: Partition,
    joint: JointScene | None,
    evidence_of: Collection[int] | None,
) -> SceneLight:
    ids = partition.ids_of(surface.voxel_keys)
    if joint is None:
        known = np.searchsorted(np.array(partition.ids), ids)
        joint = infer_jointly(surface, observed, np.where(ids == UNASSIGNED, -1, known))
    filled = joint.light.filled
    evidence, inferred = {}, {}
    for material_id, part in partition.parts(surface):
        voxels = np.flatnonzero(ids == material_id)
        if joint.has_albedo(voxels):
            if evidence_of is None or material_id in evidence_of:
                evidence[material_id] = material_evidence(part, filled, joint.occluders)
            bright, dim = joint.of_voxels(voxels)
            inferred[material_id] = (bright, bright, dim)
    light = joint.light.light
    return SceneLight(observed, filled, light, joint.occluders, evidence, inferred, joint)


def seen_light(surface: ObservedSurface) -> ObservedLight:
    """Return the light that a surface was seen in; :func:`assumed_light` where none was seen.

    Args:
        surface: with or without light.
    """
    light = surface.light
    return assumed_light(surface) if light is None or not light.coverage.any() else light


def assumed_light(surface: ObservedSurface) -> ObservedLight:
    """Assume grey light from everywhere, as strong as gives the surface the usual albedo.

    Args:
        surface: its mean colour sets the strength.
    """
    brightness = float(srgb.LINEAR[surface.colours].mean()) if len(surface.colours) else 0.0
    radiance = np.full((SIZE, SIZE, 3), brightness / USUAL_ALBEDO, np.float32)
    coverage = np.full((SIZE, SIZE), ASSUMED_COVERAGE, np.float32)
    return ObservedLight(radiance, coverage, np.zeros((SIZE, SIZE, 3), np.float32))


def _inferred(
    evidence: MaterialEvidence, filled: LightPyramid, parts: LightParts, share: float
) -> Inferences:
    """The light by diffuse colours, and by observations with gloss.

    What is far from a fit with gloss loses its weight in the next turn, so that a small change of
    the observations can lead elsewhere; the mean of the fits to several sets of voxels moves less.
    """
    count = len(evidence.voxels)
    sets = min(SETS, max(count // SMALLEST_SET, 1))
    response = diffuse_response(parts, evidence.incoming)
    shading = infer_from_shading(response, evidence.colours)
    found = [
        _inferred_by_gloss(
            np.arange(first, count, sets), evidence, filled, response, shading, share
        )
        for first in range(sets)
    ]
    bright, dim = (InferredLight.mean(of_sets) for of_sets in zip(*found, strict=True))
    return shading, bright, dim


def _inferred_by_gloss(
    members: NDArray[np.int64],
    evidence: MaterialEvidence,
    filled: LightPyramid,
    response: PatchResponse,
    shading: InferredLight,
    share: float,
) -> list[InferredLight]:
    """The light by observations of some of the evidence's voxels, and that by a dim prior."""
    used = sampled(evidence.surface, evidence.voxels[members])
    used = used.every(round(USED_OBSERVATIONS / share))
    mirrored = reflection(
        filled,
        evidence.gloss.roughness,
        used.normals[used.voxel_of],
        used.directions,
        evidence.sight.of(members[used.voxel_of]),
    )
    answers = PatchResponse(response.answers[:, members])
    return infer_light_by_gloss(
        used, answers, mirrored, evidence.gloss, shading.albedo, (BRIGHT, DIM)
    )
