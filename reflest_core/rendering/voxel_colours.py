# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Colours to show a scanned surface by: 8-bit sRGB for each voxel."""

from __future__ import annotations

import enum

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.models import Ward
from reflest_core.brdf.parameters import WardParameters
from reflest_core.rendering.sphere import tone_map
from reflest_core.surface.observed_surface import ObservedSurface

Colours = NDArray[np.uint8]

UNKNOWN = 96
"""Grey of a voxel of which nothing is known."""

SCALE = np.array(
    [[28, 16, 68], [79, 18, 123], [161, 42, 99], [224, 93, 55], [252, 173, 18], [252, 255, 164]]
)
"""Few to many: a scale of rising lightness, which also colour-blind eyes and grey prints order."""


class VoxelColouring(enum.Enum):
    """What a voxel's colour means."""

    OBSERVED = "observed"
    VIEWS = "views"
    ESTIMATE = "estimate"


def observed_colours(surface: ObservedSurface) -> Colours:
    """Return the mean colour that the views saw of each voxel.

    Args:
        surface: What was observed.

    Returns:
        (V, 3) 8-bit colours.
    """
    sums = np.zeros((len(surface.colours) + 1, 3), np.int64)
    np.cumsum(surface.colours, axis=0, dtype=np.int64, out=sums[1:])
    counts = surface.observation_counts[:, None]
    totals = sums[surface.offsets[1:]] - sums[surface.offsets[:-1]]
    means = np.where(counts > 0, totals / np.maximum(counts, 1), UNKNOWN)
    return np.round(means).astype(np.uint8)


def view_count_colours(counts: NDArray[np.int64], most: int) -> Colours:
    """Colour voxels by how many views saw them, on a logarithmic scale.

    Args:
        counts: (V,) views of each voxel, at least 1.
        most: The count at the end of :data:`SCALE`.

    Returns:
        (V, 3) 8-bit colours.
    """
    place = np.log(np.clip(counts, 1, most)) / np.log(max(most, 2)) * (len(SCALE) - 1)
    knots = np.arange(len(SCALE))
    channels = [np.interp(place, knots, SCALE[:, channel]) for channel in range(3)]
    return np.round(np.stack(channels, axis=-1)).astype(np.uint8)


def estimate_colours(
    surface: ObservedSurface, material: WardParameters, eye: NDArray[np.float64]
) -> Colours:
    """Render a material on the scanned surface, seen and lit from one point.

    The lamp has an irradiance of pi on a surface that faces it, wherever that is.

    Args:
        surface: What was observed.
        material: The material.
        eye: (3,) camera and lamp, in the surface's coordinates, metres.

    Returns:
        (V, 3) 8-bit colours.
    """
    towards = eye - surface.positions.astype(np.float64)
    towards /= np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-9)
    cosine = np.sum(towards * surface.normals, axis=1)
    # An isotropic BRDF of equal directions knows them by their cosine alone.
    sine = np.sqrt(np.clip(1 - cosine**2, 0, None))
    direction = np.stack([sine, np.zeros_like(sine), cosine], axis=-1)
    value = Ward(material.variant).evaluate(np.array(material.vector), direction, direction)
    return tone_map(np.pi * value * np.clip(cosine, 0, None)[:, None])
