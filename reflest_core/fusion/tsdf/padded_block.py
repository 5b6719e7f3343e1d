# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A block with the voxels around it, and the gradient of the TSDF there.

Flat arrays of 10 x 10 x 10: in them every neighbour is at a fixed distance, so that the loops below
run over the whole array without branches and become vector instructions. What they compute for the
padding itself is meaningless and not used.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reflest_core.fusion.tsdf.tsdf_blocks import TsdfBlocks
from reflest_core.jit import compiled
from reflest_core.surface.key_index import find_row
from reflest_core.surface.voxel_key import BLOCK_EDGE, pack_key, unpack_key

EDGE = BLOCK_EDGE + 2
SIZE = EDGE**3
FIRST = EDGE**2 + EDGE + 1
"""The block's own voxels lie between here and as far from the end."""


PADDING = np.pad(np.zeros((BLOCK_EDGE,) * 3, np.float32), 1, constant_values=1.0).reshape(SIZE)
"""(1000,) 0 at the block's own voxels, else 1."""

ALL_PAIRS = np.float32(16.0)
"""Sobel weight of the pairs along an axis, where all are known."""


class PaddedBlock(NamedTuple):
    """Float32 arrays of one block.

    Attributes:
        values: (1000,) the TSDF, 0 where unobserved.
        known: (1000,) 1 where observed, else 0.
        surrounded: (1000,) 1 where all 3 x 3 x 3 voxels around are observed, else 0.
        gradient: (3, 1000) per voxel.
        pairs: (3, 1000) Sobel weight of the observed pairs along each axis, at most 16.
        scratch: (2, 1000).
    """

    values: NDArray[np.float32]
    known: NDArray[np.float32]
    surrounded: NDArray[np.float32]
    gradient: NDArray[np.float32]
    pairs: NDArray[np.float32]
    scratch: NDArray[np.float32]


@compiled
def empty_padded_block() -> PaddedBlock:
    """Reserve room for one block; a kernel.

    Returns:
        Arrays to fill.
    """
    return PaddedBlock(
        np.zeros(SIZE, np.float32),
        np.zeros(SIZE, np.float32),
        np.zeros(SIZE, np.float32),
        np.zeros((3, SIZE), np.float32),
        np.zeros((3, SIZE), np.float32),
        np.zeros((2, SIZE), np.float32),
    )


@compiled
def gather(blocks: TsdfBlocks, key: int, out: PaddedBlock) -> None:
    """Fill in a block and what surrounds it; a kernel.

    Args:
        blocks: The volume's arrays.
        key: The block.
        out: ``values``, ``known`` and ``surrounded`` are filled.
    """
    i, j, k = unpack_key(key)
    tsdf, weight = blocks.tsdf.reshape(-1), blocks.weight.reshape(-1)
    values, known = out.values, out.known
    for di in range(-1, 2):
        a0, a1, ia = _range_towards(di)
        for dj in range(-1, 2):
            b0, b1, ib = _range_towards(dj)
            for dk in range(-1, 2):
                c0, _, ic = _range_towards(dk)
                slot = find_row(
                    blocks.index_keys, blocks.index_rows, pack_key(i + di, j + dj, k + dk)
                )
                is_there = np.float32(slot >= 0)
                block = max(slot, 0) * BLOCK_EDGE**3
                for a in range(a1 - a0):
                    for b in range(b1 - b0):
                        to = ((a0 + a) * EDGE + b0 + b) * EDGE + c0
                        start = block + ((ia + a) * BLOCK_EDGE + ib + b) * BLOCK_EDGE + ic
                        if dk == 0:
                            for c in range(BLOCK_EDGE):
                                into, source = np.uint64(to + c), np.uint64(start + c)
                                known[into] = np.float32(weight[source] > 0) * is_there
                                values[into] = tsdf[source] * known[into]
                        else:
                            known[to] = np.float32(weight[start] > 0) * is_there
                            values[to] = tsdf[start] * known[to]
    _all_of_three(known, 1, out.surrounded)
    _all_of_three(out.surrounded, EDGE, out.scratch[0])
    _all_of_three(out.scratch[0], EDGE * EDGE, out.surrounded)


@compiled
def _all_of_three(known: NDArray[np.float32], step: int, out: NDArray[np.float32]) -> None:
    """Products with both neighbours at a distance; the ends stay as they are."""
    before, at, after = known[: SIZE - 2 * step], known[step:], known[2 * step :]
    inner = out[step:]
    for n in range(len(before)):
        inner[n] = before[n] * at[n] * after[n]


@compiled
def _range_towards(direction: int) -> tuple[int, int, int]:
    """The padded indices that the neighbour in ``direction`` fills, and its own first."""
    if direction < 0:
        return 0, 1, BLOCK_EDGE - 1
    if direction > 0:
        return BLOCK_EDGE + 1, BLOCK_EDGE + 2, 0
    return 1, BLOCK_EDGE + 1, 0


@compiled
def find_gradient(block: PaddedBlock, needs_pairs: bool) -> None:
    """Apply the Sobel operator over 3 x 3 x 3 voxels, to pairs of which both are known; a kernel.

    Args:
        block: ``gradient`` and ``pairs`` are filled.
        needs_pairs: Count the pairs; else the gradient holds at ``surrounded`` voxels alone.
    """
    if needs_pairs:
        _along(block, 0, EDGE * EDGE, EDGE, 1)
        _along(block, 1, EDGE, EDGE * EDGE, 1)
        _along(block, 2, 1, EDGE * EDGE, EDGE)
    else:
        _sobel(block.values, EDGE * EDGE, EDGE, 1, block.gradient[0])
        _sobel(block.values, EDGE, EDGE * EDGE, 1, block.gradient[1])
        _sobel(block.values, 1, EDGE * EDGE, EDGE, block.gradient[2])


@compiled
def _sobel(
    values: NDArray[np.float32], step: int, second: int, third: int, out: NDArray[np.float32]
) -> None:
    """Differences along ``step``, weighed (1, 2, 1) along both other steps, where all is known."""
    two, share = np.float32(2.0), np.float32(0.5) / ALL_PAIRS
    s, t, u = np.uint64(step), np.uint64(second), np.uint64(third)
    for n in range(SIZE - 2 * FIRST):
        p = np.uint64(n) + np.uint64(FIRST)
        before, after = p - u, p + u
        first = (
            (values[before - t + s] - values[before - t - s])
            + two * (values[before + s] - values[before - s])
            + (values[before + t + s] - values[before + t - s])
        )
        middle = (
            (values[p - t + s] - values[p - t - s])
            + two * (values[p + s] - values[p - s])
            + (values[p + t + s] - values[p + t - s])
        )
        last = (
            (values[after - t + s] - values[after - t - s])
            + two * (values[after + s] - values[after - s])
            + (values[after + t + s] - values[after + t - s])
        )
        out[p] = (first + two * middle + last) * share


@compiled
def _along(block: PaddedBlock, axis: int, step: int, second: int, third: int) -> None:
    """Differences along ``step``, smoothed along the two other steps."""
    gradient, pairs = block.gradient[axis], block.pairs[axis]
    difference, pair = block.scratch[0], block.scratch[1]
    _differ(
        block.values[: SIZE - 2 * step],
        block.values[2 * step :],
        block.known[: SIZE - 2 * step],
        block.known[2 * step :],
        difference[step:],
        pair[step:],
    )
    _smooth(difference, second, third, gradient)
    _smooth(pair, second, third, pairs)
    half, least = np.float32(0.5), np.float32(1.0)
    for n in range(SIZE):
        gradient[n] *= half / max(pairs[n], least)


@compiled
def _differ(
    before: NDArray[np.float32],
    after: NDArray[np.float32],
    known_before: NDArray[np.float32],
    known_after: NDArray[np.float32],
    difference: NDArray[np.float32],
    pair: NDArray[np.float32],
) -> None:
    for n in range(len(before)):
        both = known_before[n] * known_after[n]
        pair[n] = both
        difference[n] = (after[n] - before[n]) * both


@compiled
def _smooth(source: NDArray[np.float32], second: int, third: int, out: NDArray[np.float32]) -> None:
    """(1, 2, 1) along both steps, of which ``second`` is the larger one; spoils ``source``."""
    first, last = FIRST - third, SIZE - FIRST + third
    _weigh(source[first - second :], source[first:], source[first + second :], out[first:last])
    source[first:last] = out[first:last]
    first, last = FIRST, SIZE - FIRST
    _weigh(source[first - third :], source[first:], source[first + third :], out[first:last])


@compiled
def _weigh(
    before: NDArray[np.float32],
    at: NDArray[np.float32],
    after: NDArray[np.float32],
    out: NDArray[np.float32],
) -> None:
    for n in range(len(out)):
        out[n] = before[n] + np.float32(2.0) * at[n] + after[n]
