# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A camera that lies on a voxel has no direction: the normal stands in, or it does not count."""

import dataclasses

import numpy as np
import pytest

from reflest_core.inference.transport.reflected_detail import reflected_detail
from reflest_core.inference.voxel_albedo import mirrored_radiance
from reflest_core.models.grouplet.grouplets import draw_grouplets
from reflest_core.surface.coverage import seen_cells
from reflest_core.surface.surface_sample import sampled
from test.core.surfaces import sphere_surface

VOXELS = np.arange(20)


def with_cameras_on_voxels(shift=0.0):
    """Every camera lies on the voxel 3, or so close to it that the distance underflows."""
    surface = sphere_surface(20)
    positions = surface.positions - surface.positions[3]
    centres = np.full_like(surface.view_centres, shift)
    return dataclasses.replace(surface, positions=positions, view_centres=centres)


@pytest.fixture(params=[0.0, 1e-30])
def surface(request):
    return with_cameras_on_voxels(request.param)


def rows_of(surface, voxel):
    return slice(surface.offsets[voxel], surface.offsets[voxel + 1])


def test_directions_are_unit_and_the_normal_where_there_is_none(surface):
    for directions in (surface.view_directions(), sampled(surface, VOXELS).directions):
        np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, atol=1e-6)
    directions = surface.view_directions()[rows_of(surface, 3)]
    np.testing.assert_array_equal(directions, np.tile(surface.normals[3], (len(directions), 1)))


def test_other_directions_stay_as_they_are():
    surface = sphere_surface()
    voxel_of = np.repeat(np.arange(surface.voxel_count), surface.observation_counts)
    towards = surface.view_centres[surface.view_indices] - surface.positions[voxel_of]
    expected = towards / np.linalg.norm(towards, axis=1, keepdims=True)
    np.testing.assert_array_equal(surface.view_directions(), expected)


def test_coverage_leaves_it_out(surface):
    assert not seen_cells(surface, np.array([3])).any()


def test_grouplets_see_it_along_the_normal(surface):
    drawn = draw_grouplets(surface, np.array([3]), seed=1)
    shown = drawn.observations[drawn.members[0], 3:6]
    np.testing.assert_allclose(shown, np.tile(surface.normals[3], (5, 1)), atol=1e-6)


def test_detail_in_highlights_is_finite(surface):
    assert np.isfinite(reflected_detail(surface, VOXELS)).all()


def test_what_it_mirrors_is_what_a_camera_above_it_sees(surface):
    size, samples = 8, 4
    light = np.random.default_rng(0).random((size * size, 5), np.float32)
    half = np.tile(np.float32([[0.0], [0.0], [1.0]]), (1, samples))
    position, normal = surface.positions[3], surface.normals[3]

    def mirrored(camera):
        radiance = np.zeros(3)
        mirrored_radiance(
            position,
            normal,
            camera,
            light,
            np.zeros(size * size, np.int64),
            half,
            np.ones(1, np.float32),
            np.zeros((1, 3), np.float32),
            np.empty(samples),
            np.empty(samples, np.int32),
            radiance,
        )
        return radiance

    np.testing.assert_allclose(mirrored(surface.view_centres[0]), mirrored(normal), rtol=1e-5)
