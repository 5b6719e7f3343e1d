# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How much each direction counts for a surface of a given normal."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from reflest_core.light.octahedral import octahedral_directions, octahedral_solid_angles

SIZE = 24
"""Edge of the octahedral map that is summed over: 8 degrees a texel, plenty for a cosine."""


def cosine_weights(normals: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the weights with which a surface receives light.

    Args:
        normals: (V, 3) unit normals.

    Returns:
        (V, SIZE * SIZE) cosines times solid angles of the texels; rows sum to 1.
    """
    directions, angles = _sphere()
    weights = np.asarray(normals @ directions.T, np.float32)
    np.maximum(weights, 0.0, out=weights)
    weights *= angles
    weights /= weights.sum(axis=1, keepdims=True)
    return weights


@cache
def _sphere() -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    return octahedral_directions(SIZE).reshape(-1, 3), octahedral_solid_angles(SIZE).reshape(-1)
