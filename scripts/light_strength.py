#!/usr/bin/env python3
# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How well the strength of a scene's light is inferred, under many lights.

    python scripts/light_strength.py CAPTURES ENVIRONMENTS [--scenes 72] [--seed 5]

CAPTURES is a folder of captures of several materials, ENVIRONMENTS a file or folder of environment
maps. Each scene takes the geometry of a capture, and where its cameras saw the surroundings, and
relights it: an environment, measured materials, colours by the same transport that the inference
uses, with noise. So it measures what unseen light and priors cost, and nothing of what rendering
and fusion add. Of the logarithms of estimated over true albedos, the mean in a scene is the error
of its light's strength.
"""

from __future__ import annotations

import argparse
import dataclasses
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from tqdm import tqdm

from reflest_core.brdf.lab import luminance
from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.inference.joint_scene import infer_jointly
from reflest_core.inference.transport.irradiance import mean_radiance
from reflest_core.inference.transport.scene_occluders import SceneOccluders
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES, lobe_radiance
from reflest_core.light.completion import LightPyramid, levels_below
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.light.light_map import ObservedLight
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.selection import keep_voxels
from reflest_core.synbrdf.lights.environments import find_environments, load_environment, rotated
from reflest_core.synbrdf.scenes.exposure import auto_exposure, expose
from reflest_core.synbrdf.scenes.measured_materials import draw_measured
from reflest_core.viewer.lights import octahedral_light

EACH = 192
"""Voxels of a segment that are kept."""
NOISE = 0.03, 0.02
"""Standard deviations of a voxel's shading and of an observation, as a share of it."""
BOUNCES = 3
PIXELS = 2000
"""Of the surroundings and of the surface, which decide the exposure together."""

Array = NDArray[np.float32]


@dataclass(frozen=True)
class Table:
    """A scanned geometry to relight.

    Attributes:
        surface: some voxels of every segment.
        labels: (V,) their segments.
        material_of: (S,) index of each segment's material.
        coverage: (N, N) 1 where the surroundings were seen.
        occluders: surfels of the whole scan.
        segment_of_surfel: (D,) the segment of each.
    """

    surface: ObservedSurface
    labels: NDArray[np.int64]
    material_of: NDArray[np.int64]
    coverage: Array
    occluders: SceneOccluders
    segment_of_surfel: NDArray[np.int64]

    @staticmethod
    def of(capture: Path) -> Table:
        """Scan a capture and divide it into materials."""
        pipeline = Pipeline(ReflestSettings())
        for frame in open_capture(capture):
            pipeline.fuse(frame)
        found = pipeline.materials(pipeline.snapshot())
        assert found.light is not None
        joint = found.light.joint
        assert joint is not None, f"{capture} is of one material"
        occluders, labels = joint.occluders, joint.labels
        segments = int(labels.max()) + 1
        ids = [found.material_ids[labels == segment] for segment in range(segments)]
        _, material_of = np.unique([np.bincount(one).argmax() for one in ids], return_inverse=True)
        _, nearest = cKDTree(found.surface.positions).query(occluders.positions)
        kept = np.concatenate(
            [
                np.flatnonzero(labels == segment)[:: 1 + (labels == segment).sum() // EACH]
                for segment in range(segments)
            ]
        )
        return Table(
            keep_voxels(found.surface, kept),
            labels[kept],
            material_of,
            found.light.observed.coverage,
            occluders,
            labels[nearest],
        )


def scale_errors(table: Table, environment: Array, rng: np.random.Generator) -> NDArray[np.float64]:
    """Relight a table and infer its light.

    Args:
        table: the geometry.
        environment: (H, 2 H, 3) linear radiance.
        rng: draws materials and noise.

    Returns:
        (S,) logarithm of each segment's estimated over true luminance of ``rho_d``.
    """
    light = levels_below(octahedral_light(environment))
    drawn = [draw_measured(rng)[0] for _ in range(int(table.material_of.max()) + 1)]
    rho_d = np.array([one.rho_d for one in drawn], np.float32)[table.material_of]
    gloss = np.array([(one.rho_s, one.alpha) for one in drawn])[table.material_of]
    occluders = _lit(table.occluders, rho_d[table.segment_of_surfel], light)
    colours = _colours(table, light, occluders, rho_d, gloss, rng)
    finest = light.levels[0][..., :3]
    seen = finest[table.coverage > 0.0]
    metered = [rng.choice(seen, PIXELS), rng.choice(colours, PIXELS)]
    exposure = np.float32(auto_exposure(np.concatenate(metered)))
    surface = dataclasses.replace(table.surface, colours=expose(colours, float(exposure)))
    is_seen = table.coverage[..., None] > 0.0
    radiance = np.where(is_seen, np.minimum(exposure * finest, 1.0), 0.0).astype(np.float32)
    clipped = (is_seen & (exposure * finest >= 1.0)).astype(np.float32)
    sent = np.minimum(exposure * occluders.colours, np.float32(1.0))
    found = infer_jointly(
        surface,
        ObservedLight(radiance, table.coverage, clipped),
        table.labels,
        dataclasses.replace(occluders, colours=sent),
    )
    return np.asarray(np.log(luminance(found.light.rho_d) / luminance(rho_d)))


def _lit(occluders: SceneOccluders, rho_d: Array, light: LightPyramid) -> SceneOccluders:
    """Surfels with what they send, light of each other included."""
    weights = cosine_weights(occluders.normals)
    lit = dataclasses.replace(occluders, colours=np.zeros_like(rho_d))
    for _ in range(BOUNCES):
        sight = lit.sight(occluders.positions, occluders.normals, weights)
        arriving = mean_radiance(light, occluders.normals, sight)[:, :3]
        lit = dataclasses.replace(occluders, colours=rho_d * arriving)
    return lit


def _colours(
    table: Table,
    light: LightPyramid,
    occluders: SceneOccluders,
    rho_d: Array,
    gloss: NDArray[np.float64],
    rng: np.random.Generator,
) -> Array:
    """(O, 3) linear radiance of all observations."""
    surface = table.surface
    sight = occluders.sight(surface.positions, surface.normals, cosine_weights(surface.normals))
    shaded = rho_d[table.labels] * mean_radiance(light, surface.normals, sight)[:, :3]
    shaded *= np.exp(NOISE[0] * rng.standard_normal((len(shaded), 1))).astype(np.float32)
    voxel_of = np.repeat(np.arange(surface.voxel_count), surface.observation_counts)
    of_observation = surface.normals[voxel_of], surface.view_directions(), sight.of(voxel_of)
    lobes = lobe_radiance(light, *of_observation)[..., :3]
    rho_s, alpha = gloss[table.labels[voxel_of]].T
    upper = np.clip(np.searchsorted(ROUGHNESSES, alpha), 1, len(ROUGHNESSES) - 1)
    low, high = np.array(ROUGHNESSES)[[upper - 1, upper]]
    share = np.clip((alpha - low) / (high - low), 0.0, 1.0)[:, None]
    rows = np.arange(len(voxel_of))
    mirrored = (1.0 - share) * lobes[rows, upper - 1] + share * lobes[rows, upper]
    radiance = shaded[voxel_of] + rho_s[:, None] * mirrored
    noise = np.exp(NOISE[1] * rng.standard_normal(radiance.shape))
    return np.asarray(radiance * noise, np.float32)


def main() -> None:
    """Relight tables in turn and print the errors."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("captures", type=Path)
    parser.add_argument("environments", type=Path)
    parser.add_argument("--scenes", type=int, default=72)
    parser.add_argument("--seed", type=int, default=5)
    options = parser.parse_args()
    captures = sorted(path for path in options.captures.iterdir() if path.is_dir())
    tables = [Table.of(capture) for capture in tqdm(captures, unit="capture")]
    sources = find_environments(options.environments)
    rng = np.random.default_rng(options.seed)
    strengths, errors = [], []
    for index in tqdm(range(options.scenes), unit="scene"):
        source = sources[index % len(sources)]
        turned = rotated(load_environment(source), rng.uniform(0.0, 2.0 * np.pi))
        found = scale_errors(tables[rng.integers(len(tables))], turned, rng)
        found = found[np.isfinite(found)]
        strengths.append(found.mean())
        errors.append(np.abs(found).mean())
    print(f"{options.scenes} scenes under {len(sources)} lights")
    print(f"  light's strength: RMS {np.sqrt(np.mean(np.square(strengths))):.3f}", end=", ")
    print(f"mean {np.mean(strengths):.3f}")
    print(f"  albedos: mean absolute logarithm {np.mean(errors):.3f}")


if __name__ == "__main__":
    main()
