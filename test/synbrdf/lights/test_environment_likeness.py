# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One photograph under two names is found out before it gets into training."""

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.synbrdf.generation.data_set import Generation, GenerationRefused
from reflest_core.synbrdf.lights.environment_likeness import SAME, likeness
from reflest_core.synbrdf.lights.environments import resample
from reflest_core.synbrdf.lights.procedural_room import procedural_room
from reflest_core.synbrdf.scenes.splits import Split


def test_turning_and_brightness_do_not_hide_what_it_is():
    room = procedural_room(1, 32)
    assert likeness(room, 3.0 * np.roll(room, 11, axis=1)) == pytest.approx(1.0, abs=1e-6)
    larger = resample(procedural_room(1, 128), 64)
    assert likeness(resample(larger, 32), resample(procedural_room(1, 128), 32)) > SAME
    assert likeness(room, procedural_room(2, 32)) < SAME
    assert likeness(room, np.ones_like(room)) == 0.0


def test_extra_environments_serve_training_alone(tmp_path):
    rooms = {f"room{seed}": procedural_room(seed, 32) for seed in range(4)}
    np.savez(tmp_path / "known.npz", **rooms)
    np.savez(tmp_path / "more.npz", other=procedural_room(7, 32))
    known = Generation(1, {}, environments=tmp_path / "known.npz")
    both = Generation(
        1, {}, environments=tmp_path / "known.npz", extra_environments=tmp_path / "more.npz"
    )
    both.check_extra()
    for split in Split:
        before = [source.name for source in known.sources(split).environments]
        after = [source.name for source in both.sources(split).environments]
        assert after == before + (["other"] if split is Split.TRAIN else [])


def test_an_extra_environment_that_is_known_is_refused(tmp_path):
    rooms = {f"room{seed}": procedural_room(seed, 32) for seed in range(4)}
    np.savez(tmp_path / "known.npz", **rooms)
    np.savez(tmp_path / "more.npz", renamed=np.roll(rooms["room2"], 5, axis=1))
    both = Generation(
        1, {}, environments=tmp_path / "known.npz", extra_environments=tmp_path / "more.npz"
    )
    with pytest.raises(GenerationRefused, match=r"renamed .* room2"):
        both.check_extra()
