# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Surface voxels: where the zero level of the TSDF passes through a voxel's own cell.

From each sample point one Newton step along the gradient leads to its foot point on the zero level,
``x - f g / |g|^2`` (the length of ``g`` makes up for projective distances, which are too long by
the cosine of the viewing angle). A voxel whose foot point lies in its own cell is a surface voxel;
this gives one layer without holes. A voxel that was one stays one until the foot point has left by
a quarter of a voxel, so that noise does not make voxels come and go.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.tsdf.block_projection import VOXELS
from reflest_core.fusion.tsdf.padded_block import (
    EDGE,
    FIRST,
    PADDING,
    SIZE,
    PaddedBlock,
    empty_padded_block,
    find_gradient,
    gather,
)
from reflest_core.fusion.tsdf.tsdf_blocks import TsdfBlocks
from reflest_core.jit import compiled
from reflest_core.surface.key_index import find_row
from reflest_core.surface.voxel_key import BLOCK_EDGE, NO_KEY, pack_key, unpack_key

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


@compiled
def extract_surface(
    start: int,
    stop: int,
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
    """Find the surface voxels of blocks and update ``on_surface``; a kernel.

    Args:
        start: First of ``slots``.
        stop: The one after the last.
        slots: Blocks.
        voxel_size: Metres.
        truncation: Metres.
        blocks: The volume's arrays.

    Returns:
        Keys (V,) of surface voxels, their foot points (V, 3) in the world frame and outward unit
        normals (V, 3); keys (L,) of voxels that left the surface, and keys (L,) of the voxels that
        their foot points moved to (:func:`confirm_moves` checks that the surface is there) or
        ``NO_KEY``.
    """
    most = (stop - start) * VOXELS
    found_keys = np.empty(most, np.int64)
    positions = np.empty((most, 3), np.float32)
    normals = np.empty((most, 3), np.float32)
    left_keys = np.empty(most, np.int64)
    left_to = np.empty(most, np.int64)
    found, left = 0, 0
    padded = empty_padded_block()
    reach = np.empty(SIZE, np.float32)
    near = np.float32(NEAR * voxel_size / truncation)
    for slot in slots[start:stop]:
        if not _has_candidates(blocks, slot, near):
            continue
        bi, bj, bk = unpack_key(blocks.keys[slot])
        gather(blocks, blocks.keys[slot], padded)
        needs_pairs = _needs_pairs(padded, near)
        find_gradient(padded, needs_pairs)
        _find_reach(padded, needs_pairs, near, reach)
        on_surface = blocks.on_surface[slot].reshape(VOXELS)
        for n in range(VOXELS):
            a, b, c = n // BLOCK_EDGE**2, n // BLOCK_EDGE % BLOCK_EDGE, n % BLOCK_EDGE
            p = FIRST + a * EDGE * EDGE + b * EDGE + c
            was_on = on_surface[n]
            if not was_on and reach[p] > ENTER:
                continue
            i, j, k = bi * BLOCK_EDGE + a, bj * BLOCK_EDGE + b, bk * BLOCK_EDGE + c
            key = pack_key(i, j, k)
            gx, gy, gz = (padded.gradient[0, p], padded.gradient[1, p], padded.gradient[2, p])
            square = gx * gx + gy * gy + gz * gz
            along = -padded.values[p] / square
            x, y, z = i + along * gx, j + along * gy, k + along * gz
            on_surface[n] = reach[p] <= STAY
            if on_surface[n]:
                length = math.sqrt(square)
                found_keys[found] = key
                positions[found, 0], positions[found, 1] = x * voxel_size, y * voxel_size
                positions[found, 2] = z * voxel_size
                normals[found, 0], normals[found, 1] = gx / length, gy / length
                normals[found, 2] = gz / length
                found += 1
            else:
                left_keys[left] = key
                left_to[left] = NO_KEY
                if reach[p] <= LEAVE:
                    left_to[left] = pack_key(int(np.rint(x)), int(np.rint(y)), int(np.rint(z)))
                left += 1
    return (
        found_keys[:found].copy(),
        positions[:found].copy(),
        normals[:found].copy(),
        left_keys[:left].copy(),
        left_to[:left].copy(),
    )


@compiled
def confirm_moves(left_to: NDArray[np.int64], blocks: TsdfBlocks) -> None:
    """Replace those of ``left_to`` that are no surface voxels by ``NO_KEY``; a kernel.

    Args:
        left_to: (L,) voxel keys, changed in place.
        blocks: The volume's arrays.
    """
    for n in range(len(left_to)):
        if not _is_on_surface(blocks, left_to[n]):
            left_to[n] = NO_KEY


@compiled
def _has_candidates(blocks: TsdfBlocks, slot: int, near: np.float32) -> bool:
    tsdf = blocks.tsdf[slot].reshape(VOXELS)
    weight = blocks.weight[slot].reshape(VOXELS)
    on_surface = blocks.on_surface[slot].reshape(VOXELS)
    has_some = False
    for n in range(VOXELS):
        has_some |= on_surface[n] | ((weight[n] > 0) & (abs(tsdf[n]) < near))
    return has_some


@compiled
def _needs_pairs(block: PaddedBlock, near: np.float32) -> bool:
    """Whether a voxel near the surface has unknown voxels around it."""
    zero = np.float32(0.0)
    found = np.int32(0)
    for n in range(FIRST, SIZE - FIRST):
        is_near = (block.known[n] > zero) & (abs(block.values[n]) < near)
        found |= np.int32(is_near & (block.surrounded[n] + PADDING[n] == zero))
    return bool(found != 0)


@compiled
def _find_reach(
    block: PaddedBlock, needs_pairs: bool, near: np.float32, reach: NDArray[np.float32]
) -> None:
    """Largest component, in voxels, of the Newton step to the zero level; infinite for none."""
    far, zero = np.float32(np.inf), np.float32(0.0)
    gradient, pairs = block.gradient, block.pairs
    least = np.float32(LEAST_PAIRS) if needs_pairs else zero
    for n in range(FIRST, SIZE - FIRST):
        gx, gy, gz = gradient[0, n], gradient[1, n], gradient[2, n]
        square = gx * gx + gy * gy + gz * gz
        largest = max(max(abs(gx), abs(gy)), abs(gz))
        value = abs(block.values[n])
        is_one = (
            (block.known[n] > zero)
            & (value < near)
            & (pairs[0, n] >= least)
            & (pairs[1, n] >= least)
            & (pairs[2, n] >= least)
            & (square > zero)
        )
        reach[n] = value * largest / square if is_one else far


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
