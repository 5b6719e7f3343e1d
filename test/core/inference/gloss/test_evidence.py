# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which voxels are chosen: those of good normals, of free rays, beside edges of the light."""

import dataclasses

import numpy as np
import pytest

from reflest_core.inference.gloss.lobes import SEEN, lobe_light
from reflest_core.inference.gloss.mirrored_rays import OccupiedCells, leaves_object
from reflest_core.inference.gloss.normal_quality import (
    LEAST,
    MOST,
    normal_deviations,
    normal_spreads,
)
from reflest_core.inference.gloss.posterior import PARTS, spatial_parts
from reflest_core.inference.gloss.rated_surface import BANDS, RatedSurface, light_bands
from reflest_core.inference.transport.ward_lobe import reflected
from reflest_core.light.completion import complete
from test.core.inference.gloss.lit_sphere import room, sphere

LIGHT = complete(room())


def plane(spacing=0.005, edge=30):
    x, y = np.meshgrid(np.arange(edge) * spacing, np.arange(edge) * spacing)
    positions = np.stack([x.ravel(), y.ravel(), np.zeros(edge * edge)], axis=1)
    normals = np.tile([0.0, 0.0, 1.0], (edge * edge, 1))
    return positions.astype(np.float32), normals.astype(np.float32)


def test_normals_that_agree_are_good_and_those_that_differ_are_not():
    positions, normals = plane()
    np.testing.assert_allclose(np.degrees(normal_deviations(positions, normals)), LEAST, rtol=1e-6)
    noise = np.random.default_rng(0).normal(0.0, np.radians(10.0), normals.shape)
    tilted = normals + noise * [1.0, 1.0, 0.0]
    tilted = (tilted / np.linalg.norm(tilted, axis=1, keepdims=True)).astype(np.float32)
    spread = np.degrees(np.sqrt((normal_spreads(positions, tilted) ** 2).mean()))
    assert spread == pytest.approx(20.0, rel=0.1)  # two tilts, each about two axes
    assert np.median(np.degrees(normal_deviations(positions, tilted))) > 3.0


def test_a_voxel_without_neighbours_cannot_be_judged():
    positions, normals = plane(spacing=0.05, edge=3)
    np.testing.assert_allclose(np.degrees(normal_deviations(positions, normals)), MOST, rtol=1e-6)
    assert len(normal_spreads(positions[:0], normals[:0])) == 0


def test_a_ray_is_stopped_by_what_stands_before_it():
    positions, _ = plane()
    wall = positions[:, [2, 0, 1]] + np.float32([0.2, 0.0, 0.0])
    occupied = OccupiedCells.of(np.concatenate([positions, wall]))
    start = (np.array([0.07, 0.07, 0.02]) - occupied.origin) / occupied.size
    assert not leaves_object(occupied.cells, *start, 0.6, 0.0, 0.1)
    assert leaves_object(occupied.cells, *start, -0.6, 0.0, 0.1)
    assert leaves_object(occupied.cells, *start, 0.0, 0.0, 0.6)
    assert leaves_object(OccupiedCells.of(positions[:0]).cells, 0.5, 0.5, 0.5, 0.0, 0.0, 0.6)


def test_even_light_holds_no_information_and_edges_most():
    even = np.ones_like(room().radiance)
    flat = light_bands(complete(dataclasses.replace(room(), radiance=even)))
    np.testing.assert_allclose(flat[:, : 3 * BANDS], 0.0, atol=1e-5)
    np.testing.assert_allclose(flat[:, 3 * BANDS], 1.0, atol=1e-5)
    bands = light_bands(LIGHT)
    is_window = room().radiance[..., 0].ravel() > 0.5
    assert np.abs(bands[is_window, :3]).max() > 10 * np.median(np.abs(bands[~is_window, :3]))


def test_the_choice_prefers_informative_voxels_and_leaves_bad_normals_out():
    surface = sphere(room(), (0.2, 0.1, 0.05), 0.05, 0.05)
    noisy = surface.normals.copy()
    is_bad = surface.positions[:, 0] > 0.0
    noisy[is_bad] += np.random.default_rng(0).normal(0.0, 0.3, noisy[is_bad].shape)
    noisy /= np.linalg.norm(noisy, axis=1, keepdims=True)
    rated = RatedSurface.of(dataclasses.replace(surface, normals=noisy), LIGHT)
    everything = np.arange(surface.voxel_count)
    chosen = rated.choose(everything, 100)
    assert len(chosen) == 100
    assert is_bad[chosen].mean() < 0.05
    assert rated.information[chosen].min() >= np.sort(rated.information)[-100]
    np.testing.assert_array_equal(rated.choose(everything[::-1], 100), chosen)
    assert set(rated.choose(everything[::2], 100) % 2) == {0}


def test_lobes_are_those_of_the_transport_model():
    surface = sphere(room(), (0.2, 0.1, 0.05), 0.05, 0.05, voxels=300, views=3)
    owner = np.repeat(np.arange(300), surface.observation_counts)
    directions = surface.view_directions()
    gathered = lobe_light(LIGHT, surface.normals, owner, directions, np.full((300, 1), 0.1))
    expected = reflected(LIGHT, 0.1, surface.normals[owner], directions, 12, 16)
    errors = np.abs(gathered[0, :, :3] - expected)
    assert errors.mean() < 0.08 * expected.mean()
    np.testing.assert_allclose(gathered[0, :, SEEN], 1.0, atol=1e-5)
    np.testing.assert_allclose(gathered[0, :, SEEN + 1 :], 0.0)


def test_spatial_parts_are_equal_and_compact():
    positions = np.random.default_rng(0).uniform(size=(803, 3)).astype(np.float32)
    parts = spatial_parts(positions)
    counts = np.bincount(parts, minlength=PARTS)
    assert counts.max() - counts.min() <= 1
    extents = [np.ptp(positions[parts == part], axis=0).prod() for part in range(PARTS)]
    assert max(extents) < 0.2
    assert len(spatial_parts(positions[:0])) == 0
