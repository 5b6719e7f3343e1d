"""Surface voxels: where the zero level of the TSDF passes through a voxel's own cell.

From each sample point one Newton step along the gradient leads to its foot point on the zero level,
``x - f g / |g|^2`` (the length of ``g`` makes up for projective distances, which are too long by
the cosine of the viewing angle). A voxel whose foot point lies in its own cell is a surface voxel;
this gives one layer without holes. A voxel that was one stays one until the foot point has left by
a quarter of a voxel, so that noise does not make voxels come and go.

The gradient is the Sobel operator over the 3 x 3 x 3 neighbourhood, using the observed pairs.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.key_index import find_row
from reflest_core.fusion.tsdf_blocks import TsdfBlocks
from reflest_core.fusion.voxel_key import BLOCK_EDGE, NO_KEY, pack_key, unpack_key
from reflest_core.jit import compiled

ENTER = 0.5
"""A foot point within this many voxels of the sample point, along each axis, is in its cell."""

STAY = 0.75
"""A surface voxel remains one while its foot point is within this."""

LEAVE = 1.5
"""A foot point beyond this is too far for the linear step to be believed."""

NEAR = 1.25
"""Beyond this signed distance, in voxels, no foot point is sought."""

LEAST_PAIRS = 8.0
"""Sobel weight of observed pairs that each axis needs, of 16: at the rim of the seen no normal."""

_PADDED = BLOCK_EDGE + 2


@compiled
def extract_surface(
    slots: NDArray[np.int64],
    voxel_size: float,
    truncation: float,
    blocks: TsdfBlocks,
) -> tuple[
    NDArray[np.int64],
    NDArray[np.float32],
    NDArray[np.float32],
    NDArray[np.int64],
    NDArray[np.int64],
]:
    """Find the surface voxels of the blocks ``slots`` again and update ``on_surface``.

    Returns their keys (V,), foot points (V, 3) in the world frame and outward unit normals (V, 3);
    and the keys (L,) of voxels that left the surface with the key (L,) of the surface voxel that
    their foot point moved to, or ``NO_KEY``.
    """
    most = len(slots) * BLOCK_EDGE**3
    found_keys = np.empty(most, np.int64)
    positions = np.empty((most, 3), np.float32)
    normals = np.empty((most, 3), np.float32)
    left_keys = np.empty(most, np.int64)
    left_to = np.empty(most, np.int64)
    found, left = 0, 0
    values = np.empty((_PADDED, _PADDED, _PADDED), np.float32)
    offset = np.empty(3, np.float64)
    gradient = np.empty(3, np.float64)
    on_surface = blocks.on_surface
    near = NEAR * voxel_size / truncation
    for slot in slots:
        if not _has_candidates(blocks, slot, near):
            continue
        bi, bj, bk = unpack_key(blocks.keys[slot])
        _gather_padded(blocks, bi, bj, bk, values)
        for a in range(BLOCK_EDGE):
            for b in range(BLOCK_EDGE):
                for c in range(BLOCK_EDGE):
                    was_on = on_surface[slot, a, b, c]
                    value = values[a + 1, b + 1, c + 1]
                    is_near = abs(value) < near
                    if not is_near and not was_on:
                        continue
                    i, j, k = bi * BLOCK_EDGE + a, bj * BLOCK_EDGE + b, bk * BLOCK_EDGE + c
                    reach = np.inf
                    if is_near and _gradient(values, a + 1, b + 1, c + 1, gradient):
                        reach = _foot_offset(value, gradient, offset)
                    if reach <= (STAY if was_on else ENTER):
                        on_surface[slot, a, b, c] = True
                        length = math.sqrt(gradient[0] ** 2 + gradient[1] ** 2 + gradient[2] ** 2)
                        found_keys[found] = pack_key(i, j, k)
                        positions[found, 0] = (i + offset[0]) * voxel_size
                        positions[found, 1] = (j + offset[1]) * voxel_size
                        positions[found, 2] = (k + offset[2]) * voxel_size
                        for axis in range(3):
                            normals[found, axis] = gradient[axis] / length
                        found += 1
                    elif was_on:
                        on_surface[slot, a, b, c] = False
                        left_keys[left] = pack_key(i, j, k)
                        left_to[left] = NO_KEY
                        if reach <= LEAVE:
                            left_to[left] = pack_key(
                                i + int(np.rint(offset[0])),
                                j + int(np.rint(offset[1])),
                                k + int(np.rint(offset[2])),
                            )
                        left += 1
    for n in range(left):
        if not _is_on_surface(blocks, left_to[n]):
            left_to[n] = NO_KEY
    return (
        found_keys[:found].copy(),
        positions[:found].copy(),
        normals[:found].copy(),
        left_keys[:left].copy(),
        left_to[:left].copy(),
    )


@compiled
def _has_candidates(blocks: TsdfBlocks, slot: int, near: float) -> bool:
    tsdf, weight = blocks.tsdf[slot], blocks.weight[slot]
    on_surface = blocks.on_surface[slot]
    for a in range(BLOCK_EDGE):
        for b in range(BLOCK_EDGE):
            for c in range(BLOCK_EDGE):
                if on_surface[a, b, c] or (weight[a, b, c] and abs(tsdf[a, b, c]) < near):
                    return True
    return False


@compiled
def _gather_padded(
    blocks: TsdfBlocks, bi: int, bj: int, bk: int, values: NDArray[np.float32]
) -> None:
    """Copy a block with one voxel of its neighbours around it; NaN where nothing was observed."""
    for di in range(-1, 2):
        a0, a1 = _padded_range(di)
        for dj in range(-1, 2):
            b0, b1 = _padded_range(dj)
            for dk in range(-1, 2):
                c0, c1 = _padded_range(dk)
                slot = find_row(
                    blocks.index_keys, blocks.index_rows, pack_key(bi + di, bj + dj, bk + dk)
                )
                for a in range(a0, a1):
                    for b in range(b0, b1):
                        for c in range(c0, c1):
                            value = np.float32(np.nan)
                            if slot >= 0:
                                ia = a - 1 - di * BLOCK_EDGE
                                ib = b - 1 - dj * BLOCK_EDGE
                                ic = c - 1 - dk * BLOCK_EDGE
                                if blocks.weight[slot, ia, ib, ic]:
                                    value = blocks.tsdf[slot, ia, ib, ic]
                            values[a, b, c] = value


@compiled
def _padded_range(direction: int) -> tuple[int, int]:
    """The padded indices that the neighbour block in ``direction`` (-1, 0, 1) fills."""
    if direction < 0:
        return 0, 1
    if direction > 0:
        return BLOCK_EDGE + 1, BLOCK_EDGE + 2
    return 1, BLOCK_EDGE + 1


@compiled
def _gradient(
    values: NDArray[np.float32], a: int, b: int, c: int, gradient: NDArray[np.float64]
) -> bool:
    """Sobel gradient per voxel at padded index (a, b, c); False where an axis has too few pairs."""
    gx, gy, gz, wx, wy, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for p in range(-1, 2):
        for q in range(-1, 2):
            w = (2.0 - abs(p)) * (2.0 - abs(q))
            dx = float(values[a + 1, b + p, c + q]) - float(values[a - 1, b + p, c + q])
            dy = float(values[a + p, b + 1, c + q]) - float(values[a + p, b - 1, c + q])
            dz = float(values[a + p, b + q, c + 1]) - float(values[a + p, b + q, c - 1])
            if dx == dx:
                gx += w * dx
                wx += w
            if dy == dy:
                gy += w * dy
                wy += w
            if dz == dz:
                gz += w * dz
                wz += w
    if min(wx, wy, wz) < LEAST_PAIRS:
        return False
    gradient[0], gradient[1], gradient[2] = 0.5 * gx / wx, 0.5 * gy / wy, 0.5 * gz / wz
    return gx != 0.0 or gy != 0.0 or gz != 0.0


@compiled
def _foot_offset(value: float, gradient: NDArray[np.float64], offset: NDArray[np.float64]) -> float:
    """Newton step to the zero level, in voxels; returns its largest component."""
    square = gradient[0] ** 2 + gradient[1] ** 2 + gradient[2] ** 2
    reach = 0.0
    for axis in range(3):
        offset[axis] = -value * gradient[axis] / square
        reach = max(reach, abs(offset[axis]))
    return reach


@compiled
def _is_on_surface(blocks: TsdfBlocks, key: int) -> bool:
    if key == NO_KEY:
        return False
    i, j, k = unpack_key(key)
    block = pack_key(i // BLOCK_EDGE, j // BLOCK_EDGE, k // BLOCK_EDGE)
    slot = find_row(blocks.index_keys, blocks.index_rows, block)
    if slot < 0:
        return False
    return bool(blocks.on_surface[slot, i % BLOCK_EDGE, j % BLOCK_EDGE, k % BLOCK_EDGE])
