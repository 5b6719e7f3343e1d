# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Small observed surfaces for tests: points on a sphere seen from a ring of cameras."""

import numpy as np

from reflest_core.surface.observed_surface import ObservedSurface


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
