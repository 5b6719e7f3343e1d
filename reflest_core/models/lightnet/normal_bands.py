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

EDGES = (-0.6, -0.25, 0.25, 0.6)
"""Heights of unit normals between the bands."""
BANDS = len(EDGES) + 1
LEAST = 0.01
"""Added before the logarithm of a share."""

Array = NDArray[np.float32]


@dataclass(frozen=True)
class NormalBands:
    """Means over each of B bands, from below.

    ``of_channels``: (3, 3 B), of the logarithm of colour over the light as pull and push filled it,
    of that over the whole light, and of what is clipped. ``of_all``: (2 B,), of the share of the
    light that was seen, and the logarithm of the share of voxels. Where none faces, the means
    are 0.
    """

    of_channels: Array
    of_all: Array

    @staticmethod
    def of(
        normals: Array, by_fill: Array, by_whole: Array, clipped: Array, seen: Array
    ) -> NormalBands:
        """Of V voxels; (V, 3) each, but ``seen``: (V,). ``clipped`` is 1 or 0."""
        is_member = np.searchsorted(EDGES, normals[:, 2]) == np.arange(BANDS)[:, None]
        counts = is_member.sum(axis=1, keepdims=True)
        mean = (is_member / np.maximum(counts, 1)).astype(np.float32)
        of_channels = [mean @ values for values in (by_fill, by_whole, clipped)]
        shares = np.log(counts[:, 0] / max(len(normals), 1) + LEAST)
        return NormalBands(
            np.concatenate(of_channels).T.astype(np.float32),
            np.concatenate([mean @ seen, shares]).astype(np.float32),
        )
