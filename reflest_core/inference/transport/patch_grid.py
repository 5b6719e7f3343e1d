# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Directions in 64 patches: as finely as a surface resolves light, or hides it."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled, kernel_array
from reflest_core.light.cosine_weights import SIZE
from reflest_core.light.octahedral import octahedral_directions

EDGE = 8
"""Patches along an edge of the octahedral map: 25 degrees each, in the mean."""
PATCHES = EDGE * EDGE


@cache
def patch_directions() -> NDArray[np.float32]:
    """(P, 3) unit, to the patches' middles."""
    return octahedral_directions(EDGE).reshape(-1, 3)


@cache
def texels_of_patches(size: int) -> NDArray[np.int64]:
    """List the texels of each patch.

    Args:
        size: edge of an octahedral map.

    Returns:
        (P, T) indices into the flat map, T texels to a patch.
    """
    times = size // EDGE
    indices = np.arange(size * size).reshape(EDGE, times, EDGE, times)
    return indices.transpose(0, 2, 1, 3).reshape(PATCHES, times * times)


@cache
def patches_of_texels(size: int) -> NDArray[np.int64]:
    """Look up the patch of each texel.

    Args:
        size: edge of an octahedral map.

    Returns:
        (size * size,) patch indices.
    """
    patches = np.empty(size * size, np.int64)
    patches[texels_of_patches(size)] = np.arange(PATCHES)[:, None]
    return patches


def patch_shares(weights: NDArray[np.float32]) -> NDArray[np.float32]:
    """Sum texels over patches.

    Args:
        weights: (V, SIZE * SIZE) of :func:`.cosine_weights`.

    Returns:
        (V, P) share of each patch in the hemisphere, by cosine.
    """
    return _summed(kernel_array(weights, np.float32), patches_of_texels(SIZE))


@compiled
def _summed(weights: NDArray[np.float32], patch_of: NDArray[np.int64]) -> NDArray[np.float32]:
    shares = np.zeros((len(weights), PATCHES), np.float32)
    for v in range(len(weights)):
        share = shares[v]
        for texel in range(len(patch_of)):
            share[patch_of[texel]] += weights[v, texel]
    return shares


def patch_image(values: NDArray[np.float32], size: int) -> NDArray[np.float32]:
    """Spread values of patches over a map.

    Args:
        values: (P, C).
        size: edge of the octahedral map.

    Returns:
        (size, size, C).
    """
    image = values.reshape(EDGE, EDGE, -1)
    times = size // EDGE
    return np.repeat(np.repeat(image, times, axis=0), times, axis=1)
