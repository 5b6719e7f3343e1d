# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light gathered from a scene's thumbnails is the environment that lit it, in part."""

import dataclasses

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.light.equirectangular import radiance_from
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.synbrdf.lights.environments import procedural_skies
from reflest_core.synbrdf.path_tracing.sparse_scene import SparseRenderer, SparseSettings
from reflest_core.synbrdf.relit.scene_light import room_light, scene_light
from reflest_core.synbrdf.scenes.scene import draw_scene
from reflest_core.synbrdf.scenes.splits import Sources, Split


def test_the_seen_part_of_the_environment_comes_back():
    drawn = draw_scene(3, Split.VALIDATION, 0, Sources(procedural_skies(2), []), views=12)
    scene = SparseRenderer(SparseSettings(20, 12, 4, 16)).render(drawn, 3)
    every_view = scene_light(scene, np.arange(12))
    assert 0.1 < every_view.seen_share < 1.0
    is_seen = (every_view.coverage > 0) & (every_view.any_clipped == 0)
    expected = radiance_from(
        drawn.light.radiance, octahedral_directions(len(is_seen))[is_seen]
    ) * np.float32(scene.exposure)
    found = every_view.radiance[is_seen]
    assert np.corrcoef(np.log(found.ravel() + 0.02), np.log(expected.ravel() + 0.02))[0, 1] > 0.95
    assert np.median(np.abs(found - expected) / (expected + 0.02)) < 0.1
    one_view = scene_light(scene, np.arange(1))
    assert one_view.seen_share < every_view.seen_share
    assert (every_view.coverage[one_view.coverage > 0] == 1).all()


def test_the_room_is_what_all_views_show_unclipped():
    drawn = draw_scene(3, Split.VALIDATION, 0, Sources(procedural_skies(2), []), views=12)
    scene = SparseRenderer(SparseSettings(20, 12, 4, 16)).render(drawn, 3)
    room, seen = room_light(scene), scene_light(scene, np.arange(12))
    np.testing.assert_array_equal(room.is_known, seen.coverage > 0)
    is_clear = room.is_known & (seen.any_clipped == 0)
    np.testing.assert_allclose(room.radiance[is_clear], seen.radiance[is_clear], atol=0.03)
    brighter = dataclasses.replace(scene, exposure=8.0 * scene.exposure)
    assert scene_light(brighter, np.arange(12)).clipped.any()
    np.testing.assert_allclose(room_light(brighter).radiance, 8.0 * room.radiance, rtol=1e-4)
