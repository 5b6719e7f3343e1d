# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Colours over light, binned by normal elevation.

Light that was not seen is mostly above. So surfaces that face down show the albedo under light that
was seen, and the growth of colour over light from there upwards depends on the light that was not.
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
    """Means over each of B bands, from below; 0 for bands without voxels.

    Attributes:
        of_channels: (3, 3 B), of the logarithm of colour over the smoothly filled light, of that
            over the completed light, and of what is clipped.
        of_all: (2 B,), of the share of the light that was seen, and the logarithm of the share of
            voxels.
    """

    of_channels: Array
    of_all: Array

    @staticmethod
    def of(
        normals: Array, by_fill: Array, by_whole: Array, clipped: Array, seen: Array
    ) -> NormalBands:
        """Average over the bands of V voxels.

        Args:
            normals: (V, 3).
            by_fill: (V, 3), logarithm of colour over the smoothly filled light.
            by_whole: (V, 3), logarithm of colour over the completed light.
            clipped: (V, 3), 1 or 0.
            seen: (V,), share of the light that was seen.
        """
        is_member = np.searchsorted(EDGES, normals[:, 2]) == np.arange(BANDS)[:, None]
        counts = is_member.sum(axis=1, keepdims=True)
        mean = (is_member / np.maximum(counts, 1)).astype(np.float32)
        of_channels = [mean @ values for values in (by_fill, by_whole, clipped)]
        shares = np.log(counts[:, 0] / max(len(normals), 1) + LEAST)
        return NormalBands(
            np.concatenate(of_channels).T.astype(np.float32),
            np.concatenate([mean @ seen, shares]).astype(np.float32),
        )
