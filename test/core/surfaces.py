# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Small observed surfaces for tests: points on a sphere seen from a ring of cameras."""

import numpy as np

from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.voxel_key import pack_key


def sphere_surface(voxels=300, views=40, seed=0, colour=None):
    """A 15 cm sphere at the origin seen from 1 m; colour(direction, normal) or random colours."""
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(voxels, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    centres = rng.normal(size=(views, 3))
    centres /= np.linalg.norm(centres, axis=1, keepdims=True)
    towards = centres[None] - 0.15 * normals[:, None]
    towards /= np.linalg.norm(towards, axis=2, keepdims=True)
    seen = np.einsum("vwk,vk->vw", towards, normals) > 0.25
    owner, view = np.nonzero(seen)
    if colour is None:
        colours = rng.integers(0, 256, (len(owner), 3))
    else:
        colours = np.stack(
            [colour(towards[v, w], normals[v]) for v, w in zip(owner, view, strict=True)]
        )
    return ObservedSurface(
        positions=(0.15 * normals).astype(np.float32),
        normals=normals.astype(np.float32),
        offsets=np.concatenate([[0], np.cumsum(seen.sum(axis=1))]),
        colours=colours.astype(np.uint8),
        view_indices=view.astype(np.uint16),
        view_centres=centres.astype(np.float32),
        view_foreground=rng.uniform(0, 255, (views, 3)).astype(np.float32),
        view_background=rng.uniform(0, 255, (views, 3)).astype(np.float32),
    )


def patch_surface(colour, edge=24, views=40, seed=0):
    """A flat patch of neighbouring voxels of 5 mm seen from above, with keys.

    ``colour(towards, rng)``: (O, 3) 8-bit colours by (O, 3) unit vectors from voxel to camera.
    """
    rng = np.random.default_rng(seed)
    rows, columns = (grid.ravel() for grid in np.mgrid[:edge, :edge])
    positions = 0.005 * np.stack([np.zeros(edge**2), rows, columns], axis=1)
    centres = rng.normal(size=(views, 3)) * [0.2, 0.4, 0.4] + [1.0, 0.06, 0.06]
    towards = centres[None] - positions[:, None]
    towards /= np.linalg.norm(towards, axis=2, keepdims=True)
    colours = colour(towards.reshape(-1, 3), rng)
    return ObservedSurface(
        positions=positions.astype(np.float32),
        normals=np.tile(np.float32([1.0, 0.0, 0.0]), (edge**2, 1)),
        offsets=np.arange(edge**2 + 1) * views,
        colours=np.clip(colours, 0, 255).astype(np.uint8),
        view_indices=np.tile(np.arange(views, dtype=np.uint16), edge**2),
        view_centres=centres.astype(np.float32),
        view_foreground=np.full((views, 3), 100.0, np.float32),
        view_background=np.full((views, 3), 100.0, np.float32),
        keys=np.array([pack_key(0, i, j) for i, j in zip(rows, columns, strict=True)]),
    )


def without_observations(surface, count=0):
    """The same surface with only its first ``count`` voxels."""
    import dataclasses

    last = surface.offsets[count]
    return dataclasses.replace(
        surface,
        positions=surface.positions[:count],
        normals=surface.normals[:count],
        offsets=surface.offsets[: count + 1],
        colours=surface.colours[:last],
        view_indices=surface.view_indices[:last],
    )
