# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import pytest

from reflest_core.synbrdf.lights.environments import procedural_skies
from reflest_core.synbrdf.scenes.splits import Split, SplitError, sources_of
from reflest_core.synbrdf.shapes.mesh_file import MeshSource

MESHES = [MeshSource(f"m{k}", Path("m.npz"), f"m{k}") for k in range(9)]


def names(sources):
    return {e.name for e in sources.environments}, {m.name for m in sources.meshes}


def test_unseen_shares_no_light_and_no_mesh_with_training():
    skies = procedural_skies(8)
    train, validation, unseen = (names(sources_of(split, skies, MESHES, 4)) for split in Split)
    assert train == validation
    for seen, held, everything in zip(train, unseen, (8, 9), strict=True):
        assert seen
        assert held
        assert not seen & held
        assert len(seen | held) == everything


def test_the_seed_decides_who_is_held_out():
    skies = procedural_skies(8)
    one, same, other = (names(sources_of(Split.UNSEEN, skies, [], seed)) for seed in (1, 1, 2))
    assert one == same
    assert one != other


def test_a_single_environment_cannot_be_split():
    with pytest.raises(SplitError, match="at least 2 environments"):
        sources_of(Split.TRAIN, procedural_skies(1), [], 1)
