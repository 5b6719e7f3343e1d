# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A finely scanned sphere of known Ward parameters under a known light, in 8-bit colours."""

import numpy as np

from reflest_core.brdf import srgb
from reflest_core.inference.transport.irradiance import mean_radiance
from reflest_core.inference.transport.ward_lobe import reflected
from reflest_core.light.completion import complete
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.surface.observed_surface import ObservedSurface

RADIUS = 0.1
TILT = np.radians(0.7)


def room(brightest=0.9):
    """A dim room with five windows 10 to 25 degrees wide; all of it was seen, nothing clipped."""
    directions = octahedral_directions(SIZE)
    rng = np.random.default_rng(3)
    radiance = np.full((SIZE, SIZE, 3), 0.08, np.float32)
    for width in (0.09, 0.12, 0.15, 0.18, 0.22):
        towards = rng.normal((0.0, 0.0, 0.7), 1.0)
        towards /= np.linalg.norm(towards)
        tint = rng.uniform(0.8, 1.0, 3)
        radiance[directions @ towards > np.cos(width)] = brightest * tint
    return ObservedLight(
        radiance, np.ones((SIZE, SIZE), np.float32), np.zeros((SIZE, SIZE, 3), np.float32)
    )


def sphere(light, rho_d, rho_s, alpha, voxels=4000, views=20, noise=0.004, seed=0):
    """What ``views`` cameras around and above see of a sphere.

    ``rho_d``: (3,), or (V, 3) of each voxel. ``noise``: of sRGB values in [0, 1]. Normals err by
    :data:`TILT` about each tangent axis, as those of a scan do at best.
    """
    rng = np.random.default_rng(seed)
    place = np.arange(voxels) + 0.5
    height, turn = 1.0 - 2.0 * place / voxels, np.pi * (1.0 + 5.0**0.5) * place
    ring = np.sqrt(1.0 - height**2)
    normals = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
    cameras = rng.normal((0.0, 0.0, 0.5), 1.0, (views, 3))
    cameras *= 0.6 / np.linalg.norm(cameras, axis=1, keepdims=True)
    towards = cameras[None] - RADIUS * normals[:, None]
    towards /= np.linalg.norm(towards, axis=2, keepdims=True)
    owner, view = np.nonzero(np.einsum("vwk,vk->vw", towards, normals) > 0.2)
    normals = normals.astype(np.float32)
    filled = complete(light)
    diffuse = np.broadcast_to(rho_d, (voxels, 3)) * mean_radiance(filled, normals)[:, :3]
    highlights = reflected(
        filled, alpha, normals[owner], towards[owner, view].astype(np.float32), 12, 16
    )
    encoded = np.asarray(srgb.encode(diffuse[owner] + rho_s * highlights))
    colours = np.rint(255.0 * (encoded + noise * rng.normal(size=encoded.shape)))
    return ObservedSurface(
        positions=(RADIUS * normals).astype(np.float32),
        normals=tilted(normals, rng),
        offsets=np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=voxels))]),
        colours=np.clip(colours, 0, 255).astype(np.uint8),
        view_indices=view.astype(np.uint16),
        view_centres=cameras.astype(np.float32),
        view_foreground=np.full((views, 3), 128.0, np.float32),
        view_background=np.full((views, 3), 64.0, np.float32),
        light=light,
    )


def tilted(normals, rng):
    """Unit normals with a Gaussian error of :data:`TILT` about each tangent axis."""
    noisy = normals + TILT * rng.normal(size=normals.shape)
    return (noisy / np.linalg.norm(noisy, axis=1, keepdims=True)).astype(np.float32)
