# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The light of a table with balls, inferred from all of its segments; and their albedos in it."""

import dataclasses
import warnings

import numpy as np
import pytest

from reflest_core.inference.joint_light import JointInference
from reflest_core.inference.joint_scene import infer_jointly
from reflest_core.inference.light import infer_light
from reflest_core.inference.photometric_error import photometric_error
from reflest_core.inference.transport.light_patches import completed_light, patches_of
from reflest_core.inference.transport.patch_grid import PATCHES
from reflest_core.inference.transport.scene_occluders import SceneOccluders
from reflest_core.inference.transport.surface_irradiance import SurfaceSight, surface_irradiance
from reflest_core.inference.voxel_albedo import Gloss, voxel_albedo
from reflest_core.light.completion import complete, levels_below
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.segmentation.statistics import voxel_colours
from reflest_core.surface.partition import Partition
from test.core.lit_table import lit_table

VOXEL = 0.01


class Scene:
    def __init__(self):
        self.table = lit_table(VOXEL)
        self.surface, self.labels = self.table.surface, self.table.labels
        colours = voxel_colours(self.surface.colours, self.surface.offsets)
        self.places = self.surface.positions, self.surface.normals
        self.occluders = SceneOccluders.of(*self.places, colours.median)
        self.sight = SurfaceSight.of(*self.places, self.occluders)
        one = np.ones((96, 96, 1), np.float32)
        self.true_light = levels_below(np.concatenate([self.table.light, one, 0 * one], axis=-1))

    def inference(self, labels=None):
        labels = self.labels if labels is None else labels
        return JointInference(self.surface, labels, self.surface.light, self.occluders)

    def error(self, light):
        """RMS of the logarithm of irradiance over upward normals."""
        normals = np.random.default_rng(0).normal(size=(200, 3))
        normals[:, 2] = np.abs(normals[:, 2])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        weights = cosine_weights(normals.astype(np.float32))
        found, truth = (
            weights @ next(level for level in one.levels if len(level) == 24).reshape(-1, 5)
            for one in (light, self.true_light)
        )
        return float(np.sqrt((np.log(found[:, :3] / truth[:, :3]) ** 2).mean()))


@pytest.fixture(scope="module")
def scene():
    return Scene()


@pytest.fixture(scope="module")
def found(scene):
    inference = scene.inference()
    _, gloss = inference.gloss()
    return inference.infer(gloss)


def test_all_segments_together_complete_the_light(scene, found):
    assert scene.error(found.light) < 0.3
    assert scene.error(found.light) < 0.25 * scene.error(complete(scene.surface.light))


def test_what_was_seen_unclipped_stays(scene, found):
    seen = scene.surface.light
    is_sure = (seen.coverage > 0.0) & (seen.any_clipped == 0.0)
    np.testing.assert_array_equal(found.light.levels[0][is_sure, :3], seen.radiance[is_sure])


def test_albedos_come_with_the_light(scene, found):
    truth = np.array([material.rho_d for material in scene.table.materials])
    assert np.median(np.abs(np.log(found.rho_d / truth))) < 0.3


def test_deviations_are_finite_and_larger_where_less_is_known(scene, found):
    assert np.isfinite(found.rho_d_log_deviation).all()
    deviation = found.deviation()
    is_seen = scene.surface.light.coverage > 0.0
    assert np.isfinite(deviation).all()
    assert deviation[~is_seen].mean() > 10.0 * deviation[is_seen].mean()


def test_a_solution_to_begin_from_is_hardly_left(scene, found):
    inference = scene.inference()
    _, gloss = inference.gloss()
    again = inference.infer(gloss, found, 2)
    moved = np.abs(np.log(again.rho_d / found.rho_d))
    assert (moved < found.rho_d_log_deviation).all()


def test_gloss_is_fitted_under_a_light_that_is_known(scene, found):
    labels, surface = scene.labels, scene.surface
    again = infer_jointly(surface, surface.light, labels, scene.occluders, found)
    moved = np.abs(np.log(again.light.rho_d / found.rho_d))
    assert (moved < found.rho_d_log_deviation).all()


def test_unseen_light_is_weaker_under_the_dim_prior(scene, found):
    again = infer_jointly(scene.surface, scene.surface.light, scene.labels, scene.occluders)
    assert again.dim.factors[:, :PATCHES].sum() < again.light.factors[:, :PATCHES].sum()


def test_a_segment_without_voxels_has_no_albedo_and_changes_nothing(scene, found):
    inference = scene.inference(np.where(scene.labels > 1, scene.labels + 1, scene.labels))
    _, gloss = inference.gloss()
    again = inference.infer(gloss)
    assert np.isnan(again.rho_d[2]).all()
    assert scene.error(again.light) < 0.3


def test_a_material_of_segments_without_albedo_is_left_out(scene, found):
    surface, labels = scene.surface, scene.labels
    empty = int(labels.max()) + 1
    again = infer_jointly(surface, surface.light, np.append(labels[:-1], empty + 1), None, found)
    unseen = dataclasses.replace(again, labels=np.where(labels == 0, empty, labels))
    partition = Partition.of(surface, labels + 1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        light = infer_light(surface, surface.light, partition, joint=unseen, evidence_of=())
    assert set(light.inferred) == set(partition.ids) - {1}


def test_voxels_without_a_segment_are_left_out(scene):
    inference = scene.inference(np.where(scene.labels == 0, 0, -1))
    _, gloss = inference.gloss()
    assert inference.infer(gloss).rho_d.shape == (1, 3)


def test_the_same_scan_gives_the_same_bits(scene, found):
    inference = scene.inference()
    _, gloss = inference.gloss()
    again = inference.infer(gloss)
    np.testing.assert_array_equal(again.light.levels[0], found.light.levels[0])
    np.testing.assert_array_equal(again.rho_d_log_deviation, found.rho_d_log_deviation)


def test_prior_factors_fill_unseen_light_with_multiples_of_the_smooth_fill(scene):
    seen, filled = scene.surface.light, complete(scene.surface.light)
    factors = np.concatenate([np.full((3, 64), 2.0), np.zeros((3, 64))], axis=1)
    fine = completed_light(seen, filled, *patches_of(factors)).levels[0]
    unseen = seen.coverage == 0.0
    np.testing.assert_allclose(fine[unseen, :3], 2.0 * filled.levels[0][unseen, :3], rtol=1e-6)


@pytest.mark.parametrize("material", range(4))
def test_voxels_have_their_albedo_under_the_true_light(scene, material):
    voxels = np.flatnonzero(scene.labels == material)
    truth = scene.table.materials[material]
    irradiance = surface_irradiance(scene.true_light, scene.sight)[:, :3]
    gloss = Gloss(truth.rho_s, truth.alpha)
    parts = scene.surface, voxels, scene.true_light, scene.sight, irradiance, gloss
    found = voxel_albedo(*parts)
    np.testing.assert_allclose(np.median(found.rho_d, axis=0), truth.rho_d, rtol=0.15)
    error = np.abs(found.rho_d - truth.rho_d) / np.maximum(found.deviation, 0.05 * found.rho_d)
    assert np.median(error) < 2.0
    right = photometric_error(parts[0], parts[1], found.rho_d, *parts[2:])
    wrong = photometric_error(parts[0], parts[1], 0.5 * found.rho_d, *parts[2:])
    assert right < 0.15
    assert wrong > 2.0 * right


def test_a_voxel_that_was_seen_little_is_shrunk_to_its_material(scene):
    surface, material = scene.surface, scene.table.materials[0]
    voxels = np.flatnonzero(scene.labels == 0)
    irradiance = surface_irradiance(scene.true_light, scene.sight)[:, :3]
    irradiance[voxels[0]] *= 0.001  # so dark that noise is all there is
    gloss = Gloss(material.rho_s, material.alpha)
    found = voxel_albedo(surface, voxels, scene.true_light, scene.sight, irradiance, gloss)
    assert np.isfinite(found.rho_d).all()
    np.testing.assert_allclose(found.rho_d[0], np.median(found.rho_d, axis=0), rtol=0.3)


def test_no_voxels_have_no_albedo(scene):
    irradiance = surface_irradiance(scene.true_light, scene.sight)[:, :3]
    nothing = np.zeros(0, np.int64)
    gloss = Gloss(0.05, 0.1)
    parts = scene.surface, nothing, scene.true_light, scene.sight, irradiance, gloss
    found = voxel_albedo(*parts)
    assert found.rho_d.shape == (0, 3)
    assert np.isnan(photometric_error(parts[0], parts[1], found.rho_d, *parts[2:]))
