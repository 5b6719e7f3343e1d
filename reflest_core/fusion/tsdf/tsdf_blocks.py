# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The arrays of a sparse TSDF volume, as its kernels take them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class TsdfBlocks(NamedTuple):
    """N blocks of 8 x 8 x 8 voxels.

    ``index_keys``, ``index_rows``: slots of the :class:`KeyIndex` from block key to row.
    ``keys``: (N,) int64. ``tsdf``: (N, 8, 8, 8) float32, distance over truncation in [-1, 1],
    positive outside. ``weight``: (N, 8, 8, 8) uint16, 0 unobserved.
    ``on_surface``: (N, 8, 8, 8) bool, surface voxels when the block was last looked at.
    ``last_seen``: (N,) int64, frame number.
    """

    index_keys: NDArray[np.int64]
    index_rows: NDArray[np.int32]
    keys: NDArray[np.int64]
    tsdf: NDArray[np.float32]
    weight: NDArray[np.uint16]
    on_surface: NDArray[np.bool_]
    last_seen: NDArray[np.int64]
