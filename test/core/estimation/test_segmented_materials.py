# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The materials of a scanned table, without anything being said about what stands on it."""

import dataclasses

import numpy as np
import pytest

from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.estimator import Estimator, NoEstimate
from reflest_core.estimation.scan_memory import ScanMemory
from reflest_core.estimation.scene_estimates import MOST_MOVED
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.inference.transport.surface_irradiance import SurfaceSight, surface_irradiance
from reflest_core.inference.voxel_albedo import Gloss, voxel_albedo
from reflest_core.light.completion import RADIANCE
from reflest_core.light.turned_light import turned_light
from reflest_core.models.registry import network_of_model
from reflest_core.segmentation.segmenter import Segmenter
from reflest_core.surface.partition import Partition
from reflest_core.surface.selection import keep_voxels
from test.core.lit_table import MATERIALS, Material, lit_table

SETTINGS = EstimationSettings()


@pytest.fixture(scope="module")
def table():
    found = lit_table(voxel=0.006, table=0.14)
    keys = np.random.default_rng(3).permutation(found.surface.voxel_count) + 1
    order = np.argsort(keys)
    surface = dataclasses.replace(found.surface, keys=keys)
    return dataclasses.replace(
        found, surface=keep_voxels(surface, order), labels=found.labels[order]
    )


def mapped(surface, memory=None, settings=SETTINGS):
    memory = memory or ScanMemory()
    return Estimator(settings).segmented_materials(surface, memory, 5, "camera")


@pytest.fixture(scope="module")
def found(table):
    return mapped(table.surface)


def agreement(found, labels):
    """(truth, id) counts of voxels."""
    ids = found.material_ids.astype(int)
    counts = np.zeros((labels.max() + 1, ids.max() + 1), int)
    np.add.at(counts, (labels, ids), 1)
    return counts


def test_every_ball_is_a_material_of_its_own(table, found):
    counts = agreement(found, table.labels)
    assert (counts.max(axis=1) > 0.85 * counts.sum(axis=1)).all()
    assert len(set(counts.argmax(axis=1))) == 4
    purity = counts.max(axis=0).sum() / counts.sum()
    assert purity > 0.97


def test_voxels_larger_than_the_usual_radius_have_neighbours_too():
    coarse = lit_table(voxel=0.012, table=0.16)
    keys = np.arange(1, coarse.surface.voxel_count + 1)
    surface = dataclasses.replace(coarse.surface, keys=keys, voxel_size=0.012)
    counts = agreement(mapped(surface), coarse.labels)
    assert (counts.max(axis=1) > 0.8 * counts.sum(axis=1)).all()
    assert len(set(counts.argmax(axis=1))) == 4


def test_albedos_of_voxels_are_near_the_truth(table, found):
    truth = np.array([material.rho_d for material in table.materials])[table.labels]
    assert np.median(np.abs(np.log(found.rho_d / truth))) < 0.3
    assert np.isfinite(found.rho_d_stddev).all()


def test_the_map_says_how_well_its_light_is_determined_and_what_it_took(table, found):
    assert 1.0 < found.light_condition < 1e6
    assert found.segment_count >= len(found.materials)
    assert set(found.seconds) == {"segmentation", "light", "materials"}
    assert all(0.0 < one < 100.0 for one in found.seconds.values())
    whole = Partition.whole(table.surface)
    one = Estimator(SETTINGS).materials(table.surface, whole, 5, "camera")
    assert np.isnan(one.light_condition)
    assert one.segment_count == 1


def test_materials_among_others_have_weights_of_their_own(table, found):
    estimator = Estimator(SETTINGS)
    alone, among = estimator.predictor.model_id, estimator.scene_predictor.model_id
    assert alone != among
    assert {one.estimate.model_id for one in found.materials} == {among}
    assert estimator.estimate(table.surface, 5, "camera").model_id == alone


def test_weights_of_the_user_estimate_materials_among_others_too(table):
    weights = network_of_model("lightnet").model_named("lightnet").weights
    given = mapped(table.surface, settings=EstimationSettings(weights=str(weights)))
    shipped = Estimator(SETTINGS).predictor.model_id
    assert {one.estimate.model_id for one in given.materials} == {shipped}


def test_the_network_moves_albedos_no_further_than_they_go_with_the_light(found):
    light = found.light
    for material in found.materials:
        voxels = np.flatnonzero(found.material_ids == material.id)
        gloss = Gloss(material.estimate.rho_s, material.estimate.alpha)
        sight = SurfaceSight.of(found.surface.positions, found.surface.normals, light.occluders)
        irradiance = surface_irradiance(light.completed, sight)[:, RADIANCE]
        least, most = (
            voxel_albedo(found.surface, voxels, light.completed, sight, irradiance, one).rho_d
            for one in (gloss, dataclasses.replace(gloss, rho_s=0.0))
        )
        # As lit, rho_s is between none and the published one; a tenth is trimmed at either end.
        published = np.array(material.estimate.rho_d)
        assert (published > np.median(least, axis=0) * np.exp(-MOST_MOVED) * 0.8).all()
        assert (published < np.median(most, axis=0) * np.exp(MOST_MOVED) * 1.2).all()


def test_materials_reproduce_what_was_observed(found):
    assert found.materials
    for material in found.materials:
        # Where balls touch the table it is dark, and the light there is known roughly.
        assert material.photometric_error < 0.25 or material.voxel_count < 100
        assert 0.0 < material.estimate.rho_d_stddev[0] < 0.5


def test_materials_are_in_falling_order_of_area(table, found):
    areas = [material.area for material in found.materials]
    assert areas == sorted(areas, reverse=True)
    assert found.materials[0].id == agreement(found, table.labels)[0].argmax()


def test_the_same_scan_gives_the_same_bits(table, found):
    again = mapped(table.surface)
    np.testing.assert_array_equal(again.rho_d, found.rho_d)
    np.testing.assert_array_equal(again.partition.material_ids, found.partition.material_ids)
    assert again.materials == found.materials


def test_the_order_of_the_voxels_does_not_matter(table, found):
    order = np.random.default_rng(0).permutation(table.surface.voxel_count)
    again = mapped(keep_voxels(table.surface, order))
    np.testing.assert_array_equal(again.rho_d, found.rho_d)
    np.testing.assert_array_equal(again.partition.material_ids, found.partition.material_ids)


def test_ids_stay_while_the_scan_grows(table):
    memory = ScanMemory()
    half = keep_voxels(table.surface, np.flatnonzero(table.surface.positions[:, 0] > -0.02))
    first = mapped(half, memory)
    second = mapped(table.surface, memory)
    common = second.partition.ids_of(first.partition.keys)
    assert (common == first.partition.material_ids).mean() > 0.95


def test_ids_go_on_where_a_saved_scan_goes_on(table):
    memory = ScanMemory()
    first = mapped(table.surface, memory)
    given = memory.segmenter.given_ids
    again = mapped(table.surface, ScanMemory(Segmenter(given)))
    assert (first.material_ids == again.material_ids).mean() > 0.99
    assert given.next_id > max(material.id for material in first.materials)


def test_one_estimate_of_several_materials_says_so(table):
    estimate = Estimator(EstimationSettings()).estimate(table.surface, 1, "camera")
    assert estimate.status is EstimateStatus.MIXED_MATERIALS
    assert "more than one material" in estimate.status_text


def test_a_turned_world_gives_the_same_materials(table, found):
    turn = np.float32([[1, 0, 0], [0, 0, 1], [0, -1, 0]])  # z becomes -y
    surface = table.surface
    turned = dataclasses.replace(
        surface,
        positions=surface.positions @ turn.T,
        normals=surface.normals @ turn.T,
        view_centres=surface.view_centres @ turn.T,
        light=turned_light(surface.light, turn),
    )
    again = mapped(turned, settings=dataclasses.replace(SETTINGS, up=(0.0, 1.0, 0.0)))
    counts = agreement(again, table.labels)
    assert (counts.max(axis=1) > 0.85 * counts.sum(axis=1)).all()
    ratio = np.median(again.rho_d / found.rho_d)
    assert 0.8 < ratio < 1.25


def test_a_table_of_two_colours_and_one_gloss_is_one_material():
    dark = Material((0.10, 0.12, 0.08), MATERIALS[0].rho_s, MATERIALS[0].alpha)

    def squares(points):
        return 4 * (np.floor(points / 0.07).astype(int).sum(axis=1) % 2)

    scan = lit_table(0.006, table=0.14, materials=(*MATERIALS, dark), pattern=squares)
    surface = dataclasses.replace(scan.surface, keys=np.arange(1, len(scan.labels) + 1))
    found = mapped(surface)
    counts = agreement(found, scan.labels)
    assert counts.argmax(axis=1)[0] == counts.argmax(axis=1)[4]
    assert (counts.max(axis=1) > 0.85 * counts.sum(axis=1)).all()
    bright, dark = (np.median(found.rho_d[scan.labels == k], axis=0) for k in (0, 4))
    np.testing.assert_allclose(bright / dark, [3.0, 5.0 / 3.0, 1.5], rtol=0.25)


def test_the_only_material_has_the_estimate_of_the_whole_scan(table):
    ball = keep_voxels(table.surface, np.flatnonzero(table.labels == 1))
    (only,) = mapped(ball).materials
    alone = Estimator(SETTINGS).estimate(ball, 5, "camera")
    assert only.estimate.rho_d == alone.rho_d
    assert only.estimate.alpha == alone.alpha


def test_a_network_that_sees_no_light_estimates_the_same_materials(table, found):
    grouplet = dataclasses.replace(SETTINGS, model="grouplet-fast")
    other = mapped(table.surface, settings=grouplet)
    np.testing.assert_array_equal(other.partition.material_ids, found.partition.material_ids)
    assert other.light is None


def test_a_scan_without_light_has_materials_too(table):
    found = mapped(dataclasses.replace(table.surface, light=None))
    assert len(found.materials) >= 4


def test_too_few_voxels_have_no_materials(table):
    with pytest.raises(NoEstimate):
        mapped(keep_voxels(table.surface, np.arange(3)))


def test_a_scan_that_does_not_change_is_not_answered_again(table, found):
    memory = ScanMemory()
    mapped(table.surface, memory)
    first = mapped(table.surface, memory)  # by now the light has converged
    answers = dict(memory.answers)
    again = mapped(table.surface, memory)
    assert [material.id for material in again.materials] == [m.id for m in first.materials]
    kept = [memory.answers[k] is answers[k] for k in memory.answers if k in answers]
    assert all(kept)
    assert len(kept) == len(first.materials)
    # The light goes on from where it was, and moves less than it is unsure.
    moved = np.abs(again.rho_d - first.rho_d) / first.rho_d_stddev
    assert np.median(moved) < 0.3


def test_asking_again_gives_the_same_map(table):
    memory = ScanMemory()
    first = mapped(table.surface, memory)
    assert mapped(table.surface, memory) is first
    fewer = keep_voxels(table.surface, np.arange(table.surface.voxel_count - 50))
    assert mapped(fewer, memory) is not first


def test_another_network_forgets_the_answers_of_the_one_before(table):
    memory = ScanMemory()
    mapped(table.surface, memory)
    grouplet = dataclasses.replace(SETTINGS, model="grouplet-fast")
    mapped(table.surface, memory, grouplet)
    assert memory.model_id.startswith("grouplet-fast")
    assert memory.answers == {}
