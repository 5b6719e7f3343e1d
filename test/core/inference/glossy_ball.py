# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A ball of one material under a known sky, as cameras above it see it."""

import numpy as np

from reflest_core.inference.transport.irradiance import mean_radiance
from reflest_core.inference.transport.ward_lobe import lobe_radiance
from reflest_core.light.completion import complete
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.surface.surface_sample import OBSERVATIONS, SurfaceSample

VOXELS = 96


def known(radiance):
    """The light as one who saw all of it, unclipped, would have it."""
    return ObservedLight(
        radiance, np.ones((SIZE, SIZE), np.float32), np.zeros((SIZE, SIZE, 3), np.float32)
    )


def seen_below(radiance, height):
    """The light of which only directions with z below ``height`` were seen."""
    coverage = (octahedral_directions(SIZE)[..., 2] < height).astype(np.float32)
    return ObservedLight(
        radiance * coverage[..., None], coverage, np.zeros((SIZE, SIZE, 3), np.float32)
    )


def ball(radiance, rho_d, rho_s, roughness, voxels=VOXELS):
    """What 12 cameras around and above see of ``voxels``; ``roughness``: an index."""
    rng = np.random.default_rng(5)
    normals = rng.normal((0.0, 0.0, 0.5), 1.0, (voxels, 3))
    cameras = rng.normal((0.0, 0.0, 1.0), 1.0, (OBSERVATIONS, 3))
    normals, cameras = (
        (a / np.linalg.norm(a, axis=1, keepdims=True)).astype(np.float32)
        for a in (normals, cameras)
    )
    voxel_of, slot = np.nonzero(normals @ cameras.T > 0.2)
    has_view = np.unique(voxel_of)
    normals, voxel_of = normals[has_view], np.searchsorted(has_view, voxel_of)
    light = complete(known(radiance))
    diffuse = mean_radiance(light, normals)[voxel_of, :3]
    lobes = lobe_radiance(light, normals[voxel_of], cameras[slot])[:, roughness, :3]
    colours = (np.asarray(rho_d, np.float32) * diffuse + rho_s * lobes).astype(np.float32)
    return SurfaceSample(
        np.arange(len(normals)),
        normals,
        voxel_of,
        slot,
        cameras[slot],
        np.minimum(colours, 1.0),
        colours >= 1.0,
    )
