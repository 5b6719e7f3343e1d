# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np

from reflest_core.fusion import snapshot
from reflest_core.fusion.observations.observation_store import ObservationStore
from reflest_core.fusion.observations.views import ViewTable
from reflest_core.fusion.settings import FusionSettings
from reflest_core.surface.selection import keep_voxels
from reflest_core.surface.upright import upright

SETTINGS = FusionSettings()


def filled(voxels):
    views = ViewTable(4)
    for n in range(2):
        views.put(np.array([0.0, 0.0, 1.0 + n]), np.full(3, n), np.full(3, np.nan), n)
    store = ObservationStore(voxels + 10, voxels + 10, 5)
    keys = np.arange(1, voxels + 1)
    positions = np.zeros((voxels, 3), np.float32)
    positions[:, 0] = keys
    rows = store.claim(keys, store.find(keys), positions, np.ones((voxels, 3), np.float32), 1)
    colours = np.zeros((voxels, 3), np.uint8)
    store.observe(rows, colours, 0, views.centres)
    store.observe(rows[::2], colours[::2] + 9, 1, views.centres)
    return store, views


def test_groups_observations_by_voxel():
    surface = snapshot.observed_surface(*filled(3), SETTINGS)
    assert surface.offsets.tolist() == [0, 2, 3, 5]
    assert surface.view_indices.tolist() == [0, 1, 0, 0, 1]
    assert surface.colours[:, 0].tolist() == [0, 9, 0, 0, 9]
    assert surface.positions[:, 0].tolist() == [1, 2, 3]
    np.testing.assert_array_equal(surface.view_centres, [[0, 0, 1], [0, 0, 2]])
    np.testing.assert_array_equal(surface.view_foreground[:, 0], [0, 1])
    assert np.isnan(surface.view_background).all()


def test_leaves_voxels_without_observations_out():
    store, views = filled(4)
    store.drop_views(np.array([0]))
    surface = snapshot.observed_surface(store, views, SETTINGS)
    assert surface.positions[:, 0].tolist() == [1, 3]
    assert surface.offsets.tolist() == [0, 1, 2]


def test_large_store_is_thinned_evenly():
    surface = snapshot.observed_surface(*filled(1000), SETTINGS, most_voxels=50)
    assert surface.voxel_count == 50
    steps = np.diff(surface.positions[:, 0])
    assert steps.min() >= 20
    assert steps.max() <= 21


def test_every_voxel_keeps_its_key():
    surface = snapshot.observed_surface(*filled(1000), SETTINGS, most_voxels=50)
    assert surface.keys.tolist() == surface.positions[:, 0].tolist()
    turned = upright(surface, (0.0, 1.0, 0.0))
    assert turned.keys.tolist() == surface.keys.tolist()
    chosen = np.array([31, 7, 40])
    assert keep_voxels(surface, chosen).keys.tolist() == surface.keys[chosen].tolist()


def test_empty_store():
    surface = snapshot.observed_surface(ObservationStore(4, 4, 5), ViewTable(4), SETTINGS)
    assert surface.voxel_count == 0
    assert surface.offsets.tolist() == [0]
    assert surface.view_centres.shape == (0, 3)
