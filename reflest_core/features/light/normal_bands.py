# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a surface shows of its albedo by which way it faces: down, sideways or up.

Light that nobody saw is mostly above. So what faces down tells the albedo under light that was
seen, and how the ratio of colour to light grows from there upwards tells of the rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.features.light.irradiance import DARKEST

EDGES = (-0.6, -0.25, 0.25, 0.6)
"""Heights of unit normals between the bands."""
BANDS = len(EDGES) + 1
LEAST = 0.01
"""Added before the logarithm of a ratio or of a share."""

Array = NDArray[np.float32]


@dataclass(frozen=True)
class NormalBands:
    """Means over each of B bands, from below.

    ``of_channels``: (3, 3 B), the logarithm of colour over the light as pull and push filled it,
    then over the whole light, and the share that is clipped. ``of_all``: (2 B,), the share of the
    light that was seen, and the logarithm of the share of voxels. Where none faces, the others are
    0.
    """

    of_channels: Array
    of_all: Array

    @staticmethod
    def of(normals: Array, colours: Array, filled: Array, whole: Array) -> NormalBands:
        """Of V voxels: ``normals`` and linear ``colours`` (V, 3), 1 where clipped.

        ``filled``, ``whole``: (V, 5), see :func:`.weighted_radiance`.
        """
        is_member = np.searchsorted(EDGES, normals[:, 2]) == np.arange(BANDS)[:, None]
        counts = is_member.sum(axis=1, keepdims=True)
        mean = (is_member / np.maximum(counts, 1)).astype(np.float32)
        of_channels = [
            mean @ np.log(colours / np.maximum(filled[:, :3], DARKEST) + LEAST),
            mean @ np.log(colours / np.maximum(whole[:, :3], DARKEST) + LEAST),
            mean @ (colours >= 1.0).astype(np.float32),
        ]
        shares = np.log(counts[:, 0] / max(len(normals), 1) + LEAST)
        return NormalBands(
            np.concatenate(of_channels).T.astype(np.float32),
            np.concatenate([mean @ filled[:, 3], shares]).astype(np.float32),
        )
