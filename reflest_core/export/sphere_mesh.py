# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A small sphere, so that a viewer has something to show the material on."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

RINGS, SEGMENTS = 32, 64
RADIUS = 0.05
"""Metres."""


def sphere_mesh() -> tuple[NDArray[np.float32], NDArray[np.uint16]]:
    """Unit normals (V, 3) and triangles (T, 3), counter-clockwise from outside.

    Vertices are :data:`RADIUS` times the normals. y is up, as in glTF and USD.
    """
    polar = np.linspace(0, math.pi, RINGS + 1)[:, None]
    azimuth = np.linspace(0, 2 * math.pi, SEGMENTS, endpoint=False)[None]
    x, y = np.sin(polar) * np.cos(azimuth), np.broadcast_to(np.cos(polar), (RINGS + 1, SEGMENTS))
    z = np.sin(polar) * np.sin(azimuth)
    normals = np.stack([x, y, z], axis=-1).reshape(-1, 3).astype(np.float32)

    ring, segment = np.meshgrid(np.arange(RINGS), np.arange(SEGMENTS), indexing="ij")
    upper, upper_next = ring * SEGMENTS + segment, ring * SEGMENTS + (segment + 1) % SEGMENTS
    lower, lower_next = upper + SEGMENTS, upper_next + SEGMENTS
    # At a pole one triangle of each quadrilateral has no area.
    below_first = np.stack([upper, upper_next, lower], axis=-1)[1:].reshape(-1, 3)
    above_last = np.stack([upper_next, lower_next, lower], axis=-1)[:-1].reshape(-1, 3)
    return normals, np.concatenate([below_first, above_last]).astype(np.uint16)
