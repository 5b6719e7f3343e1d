# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One independent stream of random numbers for each purpose of each scene."""

from __future__ import annotations

import enum

import numpy as np

from reflest_core.synbrdf.scenes.splits import Split


@enum.unique
class Purpose(enum.Enum):
    """What a stream is for; the value is its stable number."""

    DRAW = 0
    """Material, shape, light and views."""
    DRAW_DIVERSE = 2
    """The same of training scenes under diverse light, so that they are other scenes."""
    TRACE = 1
    """Surface points and light paths."""
    DRAW_NEAR = 4
    """The same of scenes in rooms."""
    REALISM = 3
    """Faults of a real capture."""
    RELIGHT = 5
    """Another material and light for the same shape and views."""
    DRAW_TABLETOP = 6
    """Everything of a scene of several objects."""
    FUSE = 7
    """Noise of the depth images that voxels are fused from."""


def generator(seed: int, split: Split, index: int, purpose: Purpose) -> np.random.Generator:
    """Make the stream of random numbers of one scene and purpose.

    Args:
        seed: of the data set.
        split: train, validation or unseen.
        index: of the scene within its split.
        purpose: what the numbers are for.
    """
    entropy = [seed, split.number, index, purpose.value]
    return np.random.default_rng(np.random.SeedSequence(entropy))
