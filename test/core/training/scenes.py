# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes whose colours simply are the material, so that a network can learn them in a moment."""

import json

import numpy as np

from reflest_core.brdf.parameters import WardParameters
from reflest_core.synbrdf.scenes.scene_file import MANIFEST, SynbrdfScene, shard_bytes
from reflest_core.synbrdf.scenes.scene_materials import SceneMaterial, VoxelMaterials
from reflest_core.synbrdf.scenes.thumbnails import Thumbnails
from reflest_core.synbrdf.scenes.views import look_at
from reflest_core.training.data.sample import Sample
from test.core.surfaces import sphere_surface


def learnable_samples(count, seed):
    rng = np.random.default_rng(seed)
    samples = []
    for _ in range(count):
        ward = np.array([*rng.uniform(0, 0.8, 3), rng.uniform(0, 0.2), rng.uniform(0.01, 0.2)])
        surface = sphere_surface(60, 30, seed=int(rng.integers(1000)))
        surface.colours[:] = np.round(ward[:3] * 255)
        samples.append(Sample(surface, ward))
    return samples


LIGHTS = ("sunny", "dim")


def write_synbrdf(folder, lights=LIGHTS, **counts):
    """A data folder with so many learnable scenes of each split, under ``lights`` in turn."""
    folder.mkdir(parents=True, exist_ok=True)
    described = {"seed": 7, "environments": list(LIGHTS), "meshes": []}
    (folder / MANIFEST).write_text(json.dumps(described))
    for number, (split, count) in enumerate(counts.items()):
        samples = learnable_samples(count, number)
        scenes = [
            stored_scene(sample, split, index, lights[index % len(lights)])
            for index, sample in enumerate(samples)
        ]
        (folder / f"{split}-00000.safetensors").write_bytes(shard_bytes(scenes))
    return folder


def stored_scene(sample, split, index, environment="sunny"):
    centres = sample.surface.view_centres.astype(np.float64)
    poses = np.stack([look_at(centre, np.zeros(3)) for centre in centres])
    views = len(centres)
    return SynbrdfScene(
        surface=sample.surface,
        materials=VoxelMaterials.uniform(
            SceneMaterial(
                WardParameters(tuple(sample.ward[:3].tolist()), *sample.ward[3:].tolist())
            ),
            sample.surface.voxel_count,
        ),
        split=split,
        index=index,
        environment=environment,
        environment_rotation=0.0,
        shape="sphere",
        view_pattern="sphere",
        exposure=1.0,
        radiance=(sample.surface.colours / 255).astype(np.float16),
        thumbnails=Thumbnails(
            rgbe=np.full((views, 36, 48, 4), 128, np.uint8),
            is_object=np.zeros((views, 36, 48), np.bool_),
            T_world_camera=poses.astype(np.float32),
        ),
    )
