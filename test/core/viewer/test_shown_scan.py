# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The mesh that is shown, what lies under a click, and what colours mean."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from reflest_core.brdf import srgb
from reflest_core.rendering.voxel_colours import observed_colours
from reflest_core.viewer.colour_modes import VIRIDIS, ColourMode, coloured, mapped, modes_of
from reflest_core.viewer.next_views import next_views
from reflest_core.viewer.shown_scan import NO_MATERIAL, ShownScan
from test.core.export.scanned_ball import RADIUS, RED_ID, STRIPED_ID, VOXEL, scanned_ball

UP = (0.0, 0.0, 1.0)


@pytest.fixture(scope="module")
def shown():
    return ShownScan.of(*scanned_ball(), UP)


def test_vertices_lie_on_the_ball_and_know_their_material(shown):
    distances = np.linalg.norm(shown.vertices, axis=1)
    assert np.abs(distances - RADIUS).max() < VOXEL
    height = shown.vertices[:, 2]
    assert set(shown.material_ids[height > VOXEL]) == {RED_ID}
    assert set(shown.material_ids[height < -VOXEL]) == {STRIPED_ID}


def test_the_mesh_of_voxels_alone_is_the_ball_in_the_observed_colours(shown):
    _, found = scanned_ball()
    bare = replace(found.surface, colours=found.surface.colours[:0])
    bare = replace(bare, offsets=np.zeros_like(bare.offsets))
    colours = observed_colours(found.surface)
    mesh = ShownScan.of_voxels(replace(found, surface=bare), UP, VOXEL, None, colours)
    assert np.abs(np.linalg.norm(mesh.vertices, axis=1) - RADIUS).max() < VOXEL
    corners = mesh.vertices[mesh.faces].astype(float)
    faced = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("fc,fc->f", faced, corners.mean(axis=1)) > 0).mean() > 0.999
    # One surface without gaps: neighbours share their vertices.
    edges = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, uses = np.unique(edges, axis=0, return_counts=True)
    assert (uses == 2).mean() > 0.9
    assert set(modes_of(mesh)) == set(ColourMode) - {ColourMode.COVERAGE}
    _, near = cKDTree(shown.vertices).query(mesh.vertices)
    difference = np.abs(mesh.observed.astype(int) - shown.observed[near])
    assert np.median(difference) <= 3


def test_a_ray_finds_the_near_side(shown):
    vertex, point = shown.vertex_under(np.array([1.0, 0.0, 0.03]), np.array([-2.0, 0.0, 0.0]))
    assert point[0] == pytest.approx(np.sqrt(RADIUS**2 - 0.03**2), abs=VOXEL)
    assert np.linalg.norm(shown.vertices[vertex] - point) < 2 * VOXEL
    assert shown.material_at(vertex).id == RED_ID


def test_a_ray_past_the_surface_finds_nothing(shown):
    assert shown.vertex_under(np.array([1.0, 0.0, 0.5]), np.array([-1.0, 0.0, 0.0])) is None
    assert shown.vertex_under(np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0])) is None


def test_the_albedo_is_the_colour_of_the_material(shown):
    colours = coloured(shown, ColourMode.ALBEDO).colours
    red = shown.found.material(RED_ID).estimate.rho_d
    inside = shown.vertices[:, 2] > 3 * VOXEL
    assert np.abs(colours[inside] - 255 * srgb.encode(np.array(red))).max() <= 1


def test_roughness_runs_from_the_dark_end_to_the_bright_one(shown):
    colours = coloured(shown, ColourMode.ROUGHNESS).colours
    striped = shown.material_ids == STRIPED_ID
    assert (colours[striped] == VIRIDIS[-1]).all()
    assert colours[~striped].astype(int).sum(axis=1).max() < VIRIDIS[-1].sum()


def test_unknown_values_are_grey_and_the_legend_says_so():
    found = mapped(np.array([0.0, np.nan, 1.0], np.float32), 0.0, 1.0, "{:.2f}")
    assert found.colours.tolist() == [VIRIDIS[0].tolist(), [96] * 3, VIRIDIS[-1].tolist()]
    assert "0.00" in found.legend
    assert "1.00" in found.legend
    assert "unknown" in found.legend


def test_every_mode_colours_every_vertex(shown):
    assert set(modes_of(shown)) == set(ColourMode)
    for mode in set(ColourMode) - {ColourMode.RENDERED}:
        found = coloured(shown, mode)
        assert found.colours.shape == shown.vertices.shape
        assert found.colours.dtype == np.uint8
        assert found.legend


def test_vertices_without_a_material_have_none():
    scan, found = scanned_ball()
    one = type(found)(**{**vars(found), "materials": found.materials[:1]})
    shown = ShownScan.of(scan, one, UP)
    assert set(shown.material_ids) == {RED_ID, NO_MATERIAL}
    assert np.isnan(shown.rho_d[shown.material_ids == NO_MATERIAL]).all()


def test_the_next_views_are_where_no_camera_was(shown):
    suggestions = next_views(shown, RED_ID)
    assert suggestions
    surface = shown.found.surface
    eyes = surface.view_centres[surface.is_observing]
    distance = np.median(np.linalg.norm(eyes, axis=1))
    for one in suggestions:
        assert np.linalg.norm(eyes - one.start, axis=1).min() > 0.2 * distance
        assert one.start[2] > one.end[2]
