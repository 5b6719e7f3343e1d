# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scene is scanned as live: a camera that changes its exposure is found out by its background."""

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.synbrdf.lights.environments import procedural_skies
from reflest_core.synbrdf.path_tracing.sparse_scene import SparseRenderer, SparseSettings
from reflest_core.synbrdf.realism.degrade import degrade
from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.synbrdf.relit.scene_light import light_and_gains
from reflest_core.synbrdf.scenes.scene import draw_scene
from reflest_core.synbrdf.scenes.splits import Sources, Split
from reflest_core.training.data.scanned_scene import scanned

VIEWS = 30


@pytest.fixture(scope="module")
def scene():
    drawn = draw_scene(3, Split.VALIDATION, 0, Sources(procedural_skies(2), []), VIEWS)
    return SparseRenderer(SparseSettings(60, VIEWS, 4, 16)).render(drawn, 3)


def test_a_locked_exposure_is_found_locked(scene):
    views = np.arange(VIEWS)
    searched, told = scanned(scene, views), scanned(scene, views, is_exposure_locked=True)
    np.testing.assert_array_equal(searched.colours, told.colours)
    np.testing.assert_array_equal(searched.view_background, told.view_background)
    np.testing.assert_allclose(searched.light.radiance, told.light.radiance, rtol=1e-4, atol=1e-6)


def test_a_drifting_exposure_is_made_up_for(scene):
    drifting = degrade(scene, Realism.only([Effect.EXPOSURE]), np.random.default_rng(4))
    views = np.arange(VIEWS)
    shown = scanned(drifting, views)
    before, after = (stops_between(scene.surface, surface) for surface in (drifting.surface, shown))
    assert before.std() > 0.1
    assert after.std() < 0.4 * before.std()


def stops_between(surface, other):
    """By how much the other's views are brighter, from all that is clipped in neither."""
    by_view = []
    for view in range(VIEWS):
        of_view = surface.view_indices == view
        here, there = (one.colours[of_view].astype(float) for one in (surface, other))
        known = (here > 20) & (there > 20) & (here < 255) & (there < 255)
        by_view.append(np.median(2.2 * np.log2(there[known] / here[known])))
    return np.array(by_view)


def test_other_views_do_not_enter(scene):
    views = np.array([2, 5, 11])
    shown = scanned(scene, views)
    assert set(shown.view_indices.tolist()) <= {2, 5, 11}
    _, gains = light_and_gains(scene, views)
    assert (gains[np.setdiff1d(np.arange(VIEWS), views)] == 1.0).all()
