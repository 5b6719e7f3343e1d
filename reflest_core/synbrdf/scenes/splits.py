# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which environments and meshes a split may draw from: *unseen* shares none with the others."""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np

from reflest_core.errors import ReflestError
from reflest_core.synbrdf.lights.environments import EnvironmentSource
from reflest_core.synbrdf.shapes.mesh_file import MeshSource

UNSEEN_SHARE = 0.25
"""Of the environments and of the meshes."""


class Split(enum.Enum):
    """Train and validation share light and meshes, as in the paper; unseen has its own."""

    TRAIN = "train"
    VALIDATION = "validation"
    UNSEEN = "unseen"

    @property
    def number(self) -> int:
        """A stable number for seeding."""
        return list(Split).index(self)


class SplitError(ReflestError):
    """The sources cannot be divided into splits."""


@dataclass(frozen=True)
class Sources:
    """What one split draws from. ``meshes`` may be empty: then every shape is procedural."""

    environments: list[EnvironmentSource]
    meshes: list[MeshSource]


def sources_of(
    split: Split, environments: list[EnvironmentSource], meshes: list[MeshSource], seed: int
) -> Sources:
    """Choose a split's share of all sources.

    Args:
        split: train, validation or unseen.
        environments: all environments, two at least.
        meshes: all mesh files.
        seed: of the data set.
    """
    if len(environments) < 2:
        raise SplitError(
            f"an unseen split needs at least 2 environments, not {len(environments)}: give more "
            "with --environments"
        )
    rng = np.random.default_rng([seed, 0xE])
    held_environments = _held_out(rng, len(environments))
    held_meshes = _held_out(rng, len(meshes))
    is_unseen = split is Split.UNSEEN
    return Sources(
        [e for k, e in enumerate(environments) if (k in held_environments) == is_unseen],
        [m for k, m in enumerate(meshes) if (k in held_meshes) == is_unseen],
    )


def _held_out(rng: np.random.Generator, count: int) -> set[int]:
    order: list[int] = rng.permutation(count).tolist()
    return set(order[: max(round(UNSEEN_SHARE * count), min(count, 1))])
