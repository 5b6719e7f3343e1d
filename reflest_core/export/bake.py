# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Textures: what each texel of an atlas covers, and the scanned albedo there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from reflest_core.brdf import srgb

NEIGHBOURS = 6
"""Voxels that a texel's albedo is interpolated from."""
SMALLEST_AREA = 1e-5
"""Twice the area, in texels, below which a face covers none."""


def covered_texels(
    uv: NDArray[np.float32], faces: NDArray[np.int32], size: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Find the texels whose centres lie in a face.

    Args:
        uv: (N, 2) in [0, 1], v upward.
        faces: (F, 3) indices of vertices.
        size: Texels along each side.

    Returns:
        For each such texel its index in the image in row-major order (row 0 at v = 1), its face,
        and its (3,) barycentric coordinates there.
    """
    corners = np.stack([uv[:, 0], 1.0 - uv[:, 1]], axis=1).astype(np.float64)[faces] * size - 0.5
    low = np.maximum(np.ceil(corners.min(axis=1)), 0).astype(np.int64)
    high = np.minimum(np.floor(corners.max(axis=1)), size - 1).astype(np.int64)
    spans = np.maximum(high - low + 1, 0)
    counts = spans.prod(axis=1)
    face = np.repeat(np.arange(len(faces)), counts)
    place = np.arange(len(face)) - np.repeat(np.cumsum(counts) - counts, counts)
    column = low[face, 0] + place % np.maximum(spans[face, 0], 1)
    row = low[face, 1] + place // np.maximum(spans[face, 0], 1)
    a, b, c = (corners[face, corner] for corner in range(3))
    point = np.stack([column, row], axis=1)
    whole = _cross(b - a, c - a)
    is_flat = np.abs(whole) < SMALLEST_AREA
    parts = np.stack(
        [_cross(b - point, c - point), _cross(c - point, a - point), _cross(a - point, b - point)],
        axis=1,
    )
    weights = parts / np.where(is_flat, 1.0, whole)[:, None]
    is_inside = (weights >= -1e-9).all(axis=1) & ~is_flat
    return (row * size + column)[is_inside], face[is_inside], weights[is_inside]


def interpolated(
    places: NDArray[np.float32],
    labels: NDArray[np.int32],
    positions: NDArray[np.float32],
    position_labels: NDArray[np.int32],
    values: NDArray[np.float32],
    width: float,
) -> NDArray[np.float32]:
    """Interpolate values of voxels, only between voxels of a place's own label.

    Args:
        places: (P, 3) metres.
        labels: (P,) label of each place.
        positions: (V, 3) metres.
        position_labels: (V,) label of each voxel.
        values: (V, C), NaN where unknown.
        width: Standard deviation of the Gaussian weights, metres.

    Returns:
        (P, C); NaN where no near voxel of the label has a value.
    """
    is_known = np.isfinite(values).all(axis=1)
    if not is_known.any():
        return np.full((len(places), values.shape[1]), np.nan, np.float32)
    positions, position_labels = positions[is_known], position_labels[is_known]
    count = min(NEIGHBOURS, len(positions))
    distances, near = cKDTree(positions).query(places, k=count)
    distances, near = distances.reshape(-1, count), near.reshape(-1, count)
    # Relative to the nearest, so that far places have weights too.
    squared = distances**2 - distances[:, :1] ** 2
    weights = np.exp(-squared / (2 * width**2)) * (position_labels[near] == labels[:, None])
    total = weights.sum(axis=1, keepdims=True)
    summed = np.einsum("pk,pkc->pc", weights, values[is_known][near])
    found = np.where(total > 1e-9, summed / np.maximum(total, 1e-9), np.nan)
    return np.asarray(found, np.float32)


def filled(texels: NDArray[np.int64], colours: NDArray[np.float32], size: int) -> NDArray[np.uint8]:
    """An sRGB image of linear colours; texels beside the charts take the nearest one's.

    Args:
        texels: (T,) indices in row-major order.
        colours: (T, 3) linear, in [0, 1].
        size: Texels along each side.
    """
    image = np.zeros((size * size, 3), np.uint8)
    image[texels] = np.rint(255.0 * srgb.encode(np.clip(colours, 0.0, 1.0)))
    is_empty = np.ones(size * size, np.bool_)
    is_empty[texels] = False
    if is_empty.all():
        return image.reshape(size, size, 3)
    nearest = distance_transform_edt(
        is_empty.reshape(size, size), return_distances=False, return_indices=True
    )
    return np.ascontiguousarray(image.reshape(size, size, 3)[tuple(nearest)])


def _cross(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """(P,) twice the signed area that two plane vectors (P, 2) span."""
    area: NDArray[np.float64] = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return area
