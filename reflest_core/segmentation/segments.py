# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Segments: connected surface voxels of one diffuse colour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.segmentation.features import voxel_features
from reflest_core.segmentation.graph import graph_segments
from reflest_core.segmentation.scraps import attach_scraps
from reflest_core.segmentation.statistics import VoxelColours


@dataclass(frozen=True)
class SegmentSize:
    """How large segments grow.

    Attributes:
        scale: the graph segmentation's k, in units of Lab times voxels.
        least: voxels of the smallest segment.
    """

    scale: float
    least: int


INERTIA = 1.5
"""Factor by which differences count for more between voxels of different earlier segments, and for
less within one."""
MOST_SEGMENTS = 256
"""Where there are more, the smallest are joined to others."""
FINE = SegmentSize(60.0, 60)
"""Under a light that is not known yet: rather too many segments."""
COARSE = SegmentSize(300.0, 60)
"""Under the completed light."""


def segment(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    pairs: NDArray[np.int32],
    colours: VoxelColours,
    irradiance: NDArray[np.float32],
    size: SegmentSize = COARSE,
    before: NDArray[np.int64] | None = None,
) -> NDArray[np.int64]:
    """Divide a surface into segments. Under-segmentation costs more than over-segmentation.

    The result depends on the order of the voxels where differences are equal to the bit: pass them
    in the order of their keys.

    Args:
        positions: (V, 3) metres.
        normals: (V, 3) unit.
        pairs: (E, 2) neighbours, see :func:`.neighbour_pairs`.
        colours: quantiles over the views, linear.
        irradiance: (V, 3) ``E / pi``, linear, in the colours' units.
        size: how large segments grow.
        before: (V,) the segment that each voxel had in an earlier division, -1 for new voxels: what
            was together tends to stay together, and what was apart, apart.

    Returns:
        (V,) labels 0, 1, ... in the order of the segments' first voxels.
    """
    features = voxel_features(positions, normals, pairs, colours, irradiance)
    differences = features.differences
    if before is not None:
        first, second = before[pairs[:, 0]], before[pairs[:, 1]]
        is_known = (first >= 0) & (second >= 0)
        factor = np.where(first == second, 1.0 / INERTIA, INERTIA)
        differences = differences * np.where(is_known, factor, 1.0).astype(np.float32)
    pieces = graph_segments(pairs, differences, len(positions), size.scale)

    def attached(least: int) -> NDArray[np.int64]:
        return attach_scraps(pieces, pairs, differences, positions, features.values, least)

    labels = attached(size.least)
    counts = np.sort(np.bincount(labels))[::-1]
    # One voxel more than the first that is too many has.
    return labels if len(counts) <= MOST_SEGMENTS else attached(int(counts[MOST_SEGMENTS]) + 1)
