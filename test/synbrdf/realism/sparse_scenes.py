# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A sparse scene made by hand: a ball in smooth light, seen from all round."""

import numpy as np

from reflest_core.brdf.parameters import WardParameters
from reflest_core.light import rgbe
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.synbrdf.scenes.scene_materials import SceneMaterial, VoxelMaterials
from reflest_core.synbrdf.scenes.thumbnails import Thumbnails
from reflest_core.synbrdf.scenes.views import look_at

EXPOSURE = 0.5


def ball_scene(points=200, views=30, seed=0):
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(points, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    angles = np.linspace(0, 2 * np.pi, views, endpoint=False)
    centres = np.stack([np.cos(angles), np.sin(angles), 0.3 * np.ones(views)], axis=1)
    positions = 0.1 * normals
    towards = centres[None] - positions[:, None]
    cosines = np.einsum("pwk,pk->pw", towards, normals) / np.linalg.norm(towards, axis=-1)
    point_of, view_of = np.nonzero(cosines > 0.25)
    light = 0.2 + 0.6 * (normals @ np.array([0.3, 0.2, 0.9]) * 0.5 + 0.5)
    radiance = (light[point_of, None] * np.array([0.9, 0.5, 0.3])).astype(np.float16)
    images = rng.uniform(0.05, 1.5, (views, 36, 48, 3)).astype(np.float32)
    is_object = np.zeros((views, 36, 48), bool)
    is_object[:, 10:26, 14:34] = True
    thumbnails = Thumbnails(
        rgbe.encode(images),
        is_object,
        np.stack([look_at(centre, np.zeros(3)) for centre in centres]).astype(np.float32),
    )
    shown = expose(thumbnails.radiance(), EXPOSURE)
    surface = ObservedSurface(
        positions=positions.astype(np.float32),
        normals=normals.astype(np.float32),
        offsets=np.concatenate([[0], np.cumsum(np.bincount(point_of, minlength=points))]),
        colours=expose(radiance.astype(np.float32), EXPOSURE),
        view_indices=view_of.astype(np.uint16),
        view_centres=centres.astype(np.float32),
        view_foreground=np.stack([shown[w][is_object[w]].mean(axis=0) for w in range(views)]),
        view_background=np.stack([shown[w][~is_object[w]].mean(axis=0) for w in range(views)]),
    )
    return SynbrdfScene(
        surface=surface,
        materials=VoxelMaterials.uniform(
            SceneMaterial(WardParameters((0.9, 0.5, 0.3), 0.0, 0.1)),
            surface.voxel_count,
        ),
        split="train",
        index=3,
        environment="smooth",
        environment_rotation=0.0,
        shape="ball",
        view_pattern="orbit",
        exposure=EXPOSURE,
        radiance=radiance,
        thumbnails=thumbnails,
    )
