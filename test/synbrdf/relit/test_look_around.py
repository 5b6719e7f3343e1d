# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Frames that look round the room show the upper half of the light, as the camera would."""

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.light.equirectangular import radiance_from
from reflest_core.light.light_map import LightMap
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.synbrdf.lights.environments import procedural_skies
from reflest_core.synbrdf.path_tracing.sparse_scene import SparseRenderer, SparseSettings
from reflest_core.synbrdf.relit.look_around import FRAMES, look_around
from reflest_core.synbrdf.relit.scene_light import light_and_gains, scene_light
from reflest_core.synbrdf.scenes.scene import draw_scene
from reflest_core.synbrdf.scenes.splits import Sources, Split

EXPOSURE = 0.5


def gradient():
    """Brighter towards the zenith and towards one side."""
    rows, columns = np.meshgrid(np.arange(64), np.arange(128), indexing="ij")
    level = 1.2 - rows / 64 + 0.3 * np.sin(columns / 128 * 2 * np.pi)
    return np.repeat(level[..., None], 3, axis=2).astype(np.float32)


def test_the_upper_half_is_seen_as_it_is():
    light = LightMap()
    frames = look_around(gradient(), EXPOSURE)
    assert len(frames) == FRAMES
    for directions, colours in frames:
        light.add_frame(directions, colours)
    observed = light.observed()
    directions = octahedral_directions(len(observed.coverage))
    is_seen = observed.coverage > 0
    assert is_seen[directions[..., 2] > 0.3].mean() > 0.97
    assert not is_seen[directions[..., 2] < -0.6].any()
    expected = EXPOSURE * radiance_from(gradient(), directions[is_seen])
    np.testing.assert_allclose(observed.radiance[is_seen], expected, atol=0.03)


@pytest.mark.parametrize("light_of", [scene_light, lambda *args: light_and_gains(*args)[0]])
def test_it_adds_to_what_the_views_show(light_of):
    drawn = draw_scene(3, Split.VALIDATION, 0, Sources(procedural_skies(2), []), views=6)
    scene = SparseRenderer(SparseSettings(20, 6, 4, 16)).render(drawn, 3)
    frames = look_around(drawn.light.radiance, scene.exposure)
    alone = light_of(scene, np.arange(6))
    both = light_of(scene, np.arange(6), frames)
    assert both.seen_share > alone.seen_share + 0.2
    assert (both.coverage[alone.coverage > 0] == 1).all()
