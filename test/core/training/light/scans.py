# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scans at scenes that obey Eq. 1 exactly."""

import numpy as np

from reflest_core.models.lightnet import VOXELS
from reflest_core.models.lightnet.features import light_features
from reflest_core.training.light.scan_file import AXES
from reflest_core.training.light.stored_scans import StoredScans
from test.core.surfaces import sphere_surface

SLOTS, K, TRUE = 12, 8, 3


def made_scans(count, seed, noise=1.0):
    """Scans that obey ``apparent = rho_d + rho_s lobe[TRUE]`` exactly, some voxels padded.

    What fits and statistics say is ``noise``.
    """
    rng = np.random.default_rng(seed)
    ward = rng.uniform(0.05, 0.9, (count, 5)).astype(np.float32)
    seen = rng.uniform(size=(count, VOXELS, SLOTS)) < 0.7
    seen[:, 10:] &= (rng.uniform(size=(count, VOXELS - 10)) < 0.5)[..., None]
    lobe = rng.gamma(1.0, 1.0, (count, VOXELS, SLOTS, K, 3))
    apparent = ward[:, None, None, :3] + ward[:, None, None, 3:4] * lobe[:, :, :, TRUE]
    normals = rng.normal(size=(count, VOXELS, 3))
    share = rng.uniform(size=(count, VOXELS, SLOTS, K))
    arrays = {
        "is_seen": seen,
        "apparent": apparent * seen[..., None],
        "clipped": np.zeros((count, VOXELS, SLOTS, 3)),
        "cosine": rng.uniform(0.3, 1.0, (count, VOXELS, SLOTS)) * seen,
        "lobe": lobe * seen[..., None, None],
        "lobe_seen": share,
        "lobe_clipped": 0.1 * share,
        "normals": normals / np.linalg.norm(normals, axis=-1, keepdims=True),
        "diffuse_light": rng.uniform(0.2, 0.6, (count, VOXELS, 3)),
        "diffuse_seen": rng.uniform(size=(count, VOXELS)),
        "diffuse_clipped": rng.uniform(0.0, 0.1, (count, VOXELS)),
        "zones": rng.uniform(0.0, 1.0, (count, 8, 5)),
    }
    surface = sphere_surface(VOXELS, 30)
    features = light_features(surface, np.arange(VOXELS))
    for name in sorted(AXES.keys() - arrays.keys()):
        arrays[name] = noise * rng.normal(size=(count, *getattr(features, name).shape))
    as_stored = {n: a if a.dtype == bool else a.astype(np.float16) for n, a in arrays.items()}
    many = np.full(count, 100)
    return StoredScans(as_stored, ward, many, np.arange(count), np.full(count, "sky-0"))
