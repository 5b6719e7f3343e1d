# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Normals averaged over a surface's own voxels, and over no other surface's."""

import dataclasses

import numpy as np

from reflest_core.fusion.observations.observation_store import ObservationStore
from reflest_core.fusion.observations.views import ViewTable
from reflest_core.fusion.settings import FusionSettings
from reflest_core.fusion.snapshot import observed_surface
from reflest_core.surface.voxel_key import pack_key

VOXEL = 0.005
EDGE = 40
SMOOTH = FusionSettings(voxel_size=VOXEL, normal_smoothing=25.0)


def stored(places, normals):
    """A store of voxels (N, 3), each seen once."""
    views = ViewTable(4)
    views.put(np.array([0.0, 0.0, 1.0]), np.full(3, 1.0), np.full(3, 1.0), 1)
    store = ObservationStore(len(places) + 10, len(places) + 10, 5)
    keys = np.array([pack_key(*map(int, place)) for place in places])
    positions = (places * VOXEL).astype(np.float32)
    rows = store.claim(keys, store.find(keys), positions, normals.astype(np.float32), 1)
    store.observe(rows, np.zeros((len(places), 3), np.uint8), 0, views.centres)
    return store, views


def floor():
    i, j = np.meshgrid(np.arange(EDGE), np.arange(EDGE))
    return np.stack([i.ravel(), j.ravel(), np.zeros(EDGE * EDGE, int)], axis=1)


def tilted(normals, degrees):
    noise = np.radians(degrees) * np.random.default_rng(1).normal(size=normals.shape)
    return (normals + noise) / np.linalg.norm(normals + noise, axis=1, keepdims=True)


def angles(normals, truth):
    return np.degrees(np.arccos(np.clip(np.sum(normals * truth, axis=1), -1, 1)))


def test_noise_on_a_flat_surface_is_less_than_half():
    up = np.tile([0.0, 0.0, 1.0], (EDGE * EDGE, 1))
    store, views = stored(floor(), tilted(up, 3.0))
    before, after = (
        angles(observed_surface(store, views, settings).normals, up)
        for settings in (dataclasses.replace(SMOOTH, normal_smoothing=0.0), SMOOTH)
    )
    assert np.sqrt(np.mean(after**2)) < 0.5 * np.sqrt(np.mean(before**2))


def test_two_walls_that_meet_keep_their_normals():
    ground = floor()[floor()[:, 0] > 0]
    wall = np.stack([np.zeros(EDGE * EDGE, int), floor()[:, 1], floor()[:, 0]], axis=1)
    places = np.concatenate([ground, wall])
    truth = np.concatenate(
        [np.tile([0.0, 0.0, 1.0], (len(ground), 1)), np.tile([1.0, 0.0, 0.0], (len(wall), 1))]
    )
    found = observed_surface(*stored(places, truth), SMOOTH)
    assert angles(found.normals, truth).max() < 0.2


def test_normals_stay_unit_and_positions_and_colours_as_they_are():
    up = np.tile([0.0, 0.0, 1.0], (EDGE * EDGE, 1))
    store, views = stored(floor(), tilted(up, 3.0))
    plain = observed_surface(store, views, dataclasses.replace(SMOOTH, normal_smoothing=0.0))
    smooth = observed_surface(store, views, SMOOTH)
    np.testing.assert_allclose(np.linalg.norm(smooth.normals, axis=1), 1.0, rtol=1e-6)
    np.testing.assert_array_equal(smooth.positions, plain.positions)
    np.testing.assert_array_equal(smooth.colours, plain.colours)
    assert (smooth.normals != plain.normals).any()


def test_the_same_bits_for_any_number_of_threads():
    up = np.tile([0.0, 0.0, 1.0], (EDGE * EDGE, 1))
    scan = stored(floor(), tilted(up, 3.0))
    one, four = (
        observed_surface(*scan, dataclasses.replace(SMOOTH, threads=threads)).normals
        for threads in (1, 4)
    )
    np.testing.assert_array_equal(one, four)


def test_a_single_voxel_keeps_its_normal():
    normal = np.array([[0.6, 0.0, 0.8]])
    found = observed_surface(*stored(np.array([[3, 4, 5]]), normal), SMOOTH)
    np.testing.assert_allclose(found.normals, normal, rtol=1e-6)
