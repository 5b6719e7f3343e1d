# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The swatch: a small sphere of one material."""

from __future__ import annotations

import math

import numpy as np

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.export.asset import Asset, AssetMaterial, AssetMesh

RINGS, SEGMENTS = 32, 64
RADIUS = 0.05
"""Metres."""


def sphere_mesh() -> AssetMesh:
    """A sphere of radius :data:`RADIUS` around the origin."""
    polar = np.linspace(0, math.pi, RINGS + 1)[:, None]
    azimuth = np.linspace(0, 2 * math.pi, SEGMENTS, endpoint=False)[None]
    x, z = np.sin(polar) * np.cos(azimuth), np.broadcast_to(np.cos(polar), (RINGS + 1, SEGMENTS))
    y = np.sin(polar) * np.sin(azimuth)
    normals = np.stack([x, y, z], axis=-1).reshape(-1, 3).astype(np.float32)

    ring, segment = np.meshgrid(np.arange(RINGS), np.arange(SEGMENTS), indexing="ij")
    upper, upper_next = ring * SEGMENTS + segment, ring * SEGMENTS + (segment + 1) % SEGMENTS
    lower, lower_next = upper + SEGMENTS, upper_next + SEGMENTS
    # At a pole one triangle of each quadrilateral has no area.
    below_first = np.stack([upper, lower, upper_next], axis=-1)[1:].reshape(-1, 3)
    above_last = np.stack([upper_next, lower, lower_next], axis=-1)[:-1].reshape(-1, 3)
    faces = np.concatenate([below_first, above_last]).astype(np.int32)
    used, flat = np.unique(faces, return_inverse=True)
    return AssetMesh(
        normals[used] * np.float32(RADIUS),
        normals[used],
        flat.reshape(-1, 3).astype(np.int32),
        np.zeros(len(faces), np.int32),
    )


def swatch(estimate: BrdfEstimate, light_file: str = "") -> Asset:
    """The sphere with an estimate's material.

    Args:
        estimate: The material.
        light_file: Path of an environment file from the swatch's folder, or "".

    Raises:
        ExportError: A value of the estimate is not physical.
    """
    material = AssetMaterial.of(estimate, "reflest_material")
    return Asset("reflest", sphere_mesh(), (material,), light_file=light_file, is_swatch=True)
