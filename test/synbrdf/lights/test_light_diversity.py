# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light for training: new with every draw, natural in kind, and only in training scenes."""

import numpy as np
import pytest

from reflest_core.light.equirectangular import equirectangular_directions
from reflest_core.synbrdf.generation.data_set import Generation, GenerationRefused
from reflest_core.synbrdf.lights.environments import procedural_skies
from reflest_core.synbrdf.lights.light_diversity import draw_diverse_light
from reflest_core.synbrdf.lights.procedural_room import procedural_room
from reflest_core.synbrdf.lights.procedural_sky import procedural_sky
from reflest_core.synbrdf.scenes.scene import Lighting, draw_scene
from reflest_core.synbrdf.scenes.splits import Sources, Split

FAR = (Lighting.NATURAL, Lighting.DIVERSE)
MAPS = {f"sky-{seed}": procedural_sky(seed, 32) for seed in range(3)}


@pytest.mark.parametrize("seed", range(12))
def test_every_draw_is_light_and_like_no_source(seed):
    radiance = draw_diverse_light(np.random.default_rng(seed), MAPS).radiance
    assert radiance.shape == (32, 64, 3)
    assert np.isfinite(radiance).all()
    assert radiance.min() >= 0.0
    assert radiance.mean() > 0.0
    again = draw_diverse_light(np.random.default_rng(seed), MAPS).radiance
    np.testing.assert_array_equal(radiance, again)
    for source in MAPS.values():
        assert abs(np.corrcoef(radiance.ravel(), source.ravel())[0, 1]) < 0.999


@pytest.mark.parametrize("seed", range(12))
def test_it_names_the_environments_that_it_would_not_be_the_same_without(seed):
    drawn = draw_diverse_light(np.random.default_rng(seed), MAPS)
    for name in MAPS:
        others = {**MAPS, name: MAPS[name][:, ::-1] ** 2}
        again = draw_diverse_light(np.random.default_rng(seed), others)
        assert again.natural == drawn.natural
        assert (name in drawn.natural) == (again.radiance != drawn.radiance).any()


def test_a_room_is_brightest_at_its_lamps_and_windows_and_no_lamp_is_below():
    below = equirectangular_directions(64)[..., 2] < -0.7
    for seed in range(8):
        light = procedural_room(seed, 64).mean(axis=-1)
        assert light.mean() == pytest.approx(1.0, abs=1e-3)
        assert light.max() > 8.0 * np.median(light)
        assert light[below].max() < 0.2 * light.max()


def test_only_training_scenes_get_it():
    sources = Sources(procedural_skies(3), [])
    scenes = {
        split: [draw_scene(1, split, 0, sources, 5, lighting) for lighting in FAR]
        for split in Split
    }
    natural, diverse = scenes[Split.TRAIN]
    kind, *mixed = diverse.light.name.split("+")
    assert kind == "diverse"
    assert set(mixed) <= {source.name for source in sources.environments}
    assert natural.light.name.startswith("sky-")
    assert diverse.painted.dominant != natural.painted.dominant
    for split in (Split.VALIDATION, Split.UNSEEN):
        natural, diverse = scenes[split]
        np.testing.assert_array_equal(diverse.light.radiance, natural.light.radiance)


def test_environments_can_be_kept_from_training():
    every = Generation(1, {}).sources(Split.TRAIN).environments
    kept_back = every[0].name
    fewer = Generation(1, {}, without=(kept_back,)).sources(Split.TRAIN).environments
    with pytest.raises(GenerationRefused, match="nowhere"):
        Generation(1, {}, without=("nowhere",)).sources(Split.TRAIN)
    assert [e.name for e in fewer] == [e.name for e in every if e.name != kept_back]
