# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Grouplet as it runs while scanning: NumPy alone, and nothing computed twice.

Nodes share observations, and a branch sees its observation alone. So each distinct observation goes
through the branch once. The node's first layer is a sum over the five places of a node: what an
observation adds to it depends on the place alone, so each distinct pair of observation and place is
multiplied once, and a node adds up five rows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import PARAMETERS
from reflest_core.inference.material import Explanation
from reflest_core.jit import compiled
from reflest_core.models import linear_algebra
from reflest_core.models.definition import Scores
from reflest_core.models.grouplet.grouplets import (
    BRANCH_INPUTS,
    BRANCHES,
    NODES_PER_VOXEL,
    SEED,
    Grouplets,
    draw_grouplets,
)
from reflest_core.models.linear_algebra import DenseLayer, one_blas_thread, run_in_threads
from reflest_core.models.weights import Tensors
from reflest_core.surface.observed_surface import ObservedSurface

SHAPES: dict[str, tuple[int, ...]] = {
    "branch.0.weight": (128, BRANCH_INPUTS),
    "branch.0.bias": (128,),
    "branch.2.weight": (128, 128),
    "branch.2.bias": (128,),
    "node.0.weight": (256, BRANCHES * 128 + 3),
    "node.0.bias": (256,),
    "node.2.weight": (128, 256),
    "node.2.bias": (128,),
    "regressor.0.weight": (128, 256),
    "regressor.0.bias": (128,),
    "regressor.2.weight": (128, 128),
    "regressor.2.bias": (128,),
    "regressor.4.weight": (5, 128),
    "regressor.4.bias": (len(PARAMETERS),),
}

NODES_AT_ONCE = 16 * NODES_PER_VOXEL
"""What these nodes need stays in a core's own cache."""

Array = NDArray[np.float32]
Moments = NDArray[np.float64]


class LiveGrouplet:
    """The network of ``models/grouplet/network.py`` with ``tensors`` of :data:`SHAPES`.

    The same grouplets give the same bits, whatever ``threads``.
    """

    def __init__(self, tensors: Tensors, threads: int) -> None:
        """Take the weights and make room for each thread.

        Args:
            tensors: The trained weights by name.
            threads: CPU threads that it may use.
        """
        self._branch = [DenseLayer.of(tensors, f"branch.{n}") for n in (0, 2)]
        node = DenseLayer.of(tensors, "node.0")
        self._places = node.weight[: BRANCHES * 128].reshape(BRANCHES, 128, 256)
        self._normal = DenseLayer(node.weight[BRANCHES * 128 :], node.bias)
        self._node = DenseLayer.of(tensors, "node.2")
        self._regressor = [DenseLayer.of(tensors, f"regressor.{n}") for n in (0, 2, 4)]
        self._workspaces = [_Workspace() for _ in range(threads)]

    def scores(
        self,
        surface: ObservedSurface,
        choices: Sequence[NDArray[np.int64]],
        found: Explanation | None = None,
    ) -> list[Scores]:
        """Estimate from ten grouplets of each voxel.

        Args:
            surface: A scan, or a material's part of one, upright (+z is up).
            choices: (N,) indices of voxels, all observed, of each choice.
            found: The material in the light of its scene; not used, for the network sees no light.
        """
        drawn = (draw_grouplets(surface, voxels, SEED) for voxels in choices)
        return [Scores(self.evaluate(grouplets)) for grouplets in drawn]

    def evaluate(self, drawn: Grouplets) -> Array:
        """Estimate (5,) z-scored parameters.

        Args:
            drawn: Grouplets of one surface.
        """
        starts = range(0, len(drawn.members), NODES_AT_ONCE)
        sums = np.empty((len(starts), 2, 128), np.float64)

        def work(worker: int) -> None:
            for part in range(worker, len(starts), len(self._workspaces)):
                nodes = slice(starts[part], starts[part] + NODES_AT_ONCE)
                described = self._describe(drawn, nodes, self._workspaces[worker])
                _sum_moments(described, sums[part])

        with one_blas_thread():
            run_in_threads(work, len(self._workspaces))
            return self._regress(sums.sum(axis=0) / len(drawn.members))

    def _describe(self, drawn: Grouplets, nodes: slice, space: _Workspace) -> Array:
        """The nodes' 128 values each, before pooling; they stay in ``space``."""
        members = drawn.members[nodes]
        first, last, rows, ends, summands = observations_by_place(members)
        hidden = self._branch[0].tanh(drawn.observations[first:last], space.hidden)
        branches = self._branch[1].tanh(hidden, space.branches)
        # The hidden values are done with: their place takes the branches of all pairs.
        paired = np.take(branches, rows, axis=0, out=space.hidden[: len(rows)], mode="clip")
        products = space.products[: len(rows)]
        for place, matrix in enumerate(self._places):
            part = slice(ends[place], ends[place + 1])
            linear_algebra.product(paired[part], matrix, products[part])
        inputs = space.inputs[: len(members)]
        _add_up(products, summands, drawn.normals[nodes], *self._normal, inputs)
        return self._node.tanh(np.tanh(inputs, out=inputs), space.nodes)

    def _regress(self, moments: Moments) -> Array:
        """Scores from the means (128,) and the mean squares (128,) over all nodes."""
        mean, mean_square = moments
        values: Array = np.concatenate([mean, mean_square - mean**2]).astype(np.float32)
        first, second, last = self._regressor
        return last.linear(second.tanh(first.tanh(values)))


class _Workspace:
    """What one thread writes to: kept, because fresh memory costs more than what is done in it."""

    def __init__(self) -> None:
        most = NODES_AT_ONCE * BRANCHES
        self.hidden = np.empty((most, 128), np.float32)
        self.branches = np.empty((most, 128), np.float32)
        self.products = np.empty((most, 256), np.float32)
        self.inputs = np.empty((NODES_AT_ONCE, 256), np.float32)
        self.nodes = np.empty((NODES_AT_ONCE, 128), np.float32)


@compiled
def observations_by_place(
    members: NDArray[np.int32],
) -> tuple[int, int, NDArray[np.int32], NDArray[np.int64], NDArray[np.int32]]:
    """Find the distinct pairs of observation and place.

    Args:
        members: (G, 5) rows of observations.

    Returns:
        The first observation and one past the last; the observation of each pair (P,), counted from
        the first, ordered by place; where each place's pairs begin and the last ones end (6,); and
        the pairs of each node (G, 5).
    """
    first, last = members.min(), members.max() + 1
    pair_of = np.full((BRANCHES, last - first), -1, np.int32)
    for node in members:
        for place in range(BRANCHES):
            pair_of[place, node[place] - first] = 0
    rows = np.empty(members.size, np.int32)
    ends = np.zeros(BRANCHES + 1, np.int64)
    pairs = 0
    for place in range(BRANCHES):
        for row in range(last - first):
            if pair_of[place, row] == 0:
                pair_of[place, row] = pairs
                rows[pairs] = row
                pairs += 1
        ends[place + 1] = pairs
    summands = np.empty_like(members)
    for node in range(len(members)):
        for place in range(BRANCHES):
            summands[node, place] = pair_of[place, members[node, place] - first]
    return first, last, rows[:pairs], ends, summands


@compiled
def _add_up(
    products: Array,
    summands: NDArray[np.int32],
    normals: Array,
    weight: Array,
    bias: Array,
    inputs: Array,
) -> None:
    """Fill ``inputs`` (G, C): the five ``products`` of each node, its normal (G, 3), the bias."""
    for node in range(len(inputs)):
        a, b, c, d, e = summands[node]
        x, y, z = normals[node]
        for channel in range(inputs.shape[1]):
            inputs[node, channel] = (
                products[a, channel]
                + products[b, channel]
                + products[c, channel]
                + products[d, channel]
                + products[e, channel]
                + bias[channel]
                + x * weight[0, channel]
                + y * weight[1, channel]
                + z * weight[2, channel]
            )


@compiled
def _sum_moments(values: Array, sums: Moments) -> None:
    """Fill ``sums`` (2, C): of the ``values`` (G, C) over G, and of their squares."""
    sums[:] = 0.0
    for row in range(len(values)):
        for channel in range(values.shape[1]):
            value = np.float64(values[row, channel])
            sums[0, channel] += value
            sums[1, channel] += value * value
