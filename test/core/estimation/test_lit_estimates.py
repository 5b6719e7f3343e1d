# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""lightnet as an estimator: how sure it is, and what it says of the light it knows."""

import dataclasses

import numpy as np
import pytest

from reflest_core.brdf.deviations import labcd_stddev
from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.inference.light import assumed_light
from reflest_core.light.light_map import LightMap
from reflest_core.models.card import Calibration
from test.core.lit_surfaces import lit
from test.core.surfaces import sphere_surface, without_observations
from test.core.weight_files import USUAL, untrained_lightnet

SURFACE = sphere_surface(colour=lambda direction, normal: (150, 120, 100))
FACTORS = np.array([2.0, 3.0, 4.0, 5.0, 6.0])
POWERS = np.array([1.0, 1.1, 1.2, 0.9, 0.8])


@pytest.fixture(scope="module")
def weights(tmp_path_factory):
    return untrained_lightnet(tmp_path_factory.mktemp("weights"))


def estimate(surface, weights, **settings):
    chosen = {**settings, "model": "lightnet", "weights": str(weights)}
    return Estimator(EstimationSettings(**chosen)).estimate(surface, 0, "")


def ward_stddev(found):
    return np.array([*found.rho_d_stddev, found.rho_s_stddev, found.alpha_stddev])


def test_every_value_has_a_deviation_and_all_repeats_bit_for_bit(weights):
    surface = lit(SURFACE)
    found, again = (estimate(surface, weights) for _ in range(2))
    assert found.to_json() == again.to_json()
    assert found.status is EstimateStatus.UNCERTAIN_GLOSS  # a sky without edges, few voxels
    assert found.status_text.startswith("alpha cannot be determined: ")
    assert found.model_id.startswith("lightnet/")
    assert (ward_stddev(found) > 0).all()
    ward = np.array([*found.rho_d, found.rho_s, found.alpha])
    np.testing.assert_allclose(
        [*found.lab_stddev, found.c_stddev, found.d_stddev],
        labcd_stddev(ward, ward_stddev(found)),
    )


def test_the_cards_calibration_is_applied(weights, tmp_path):
    surface = lit(SURFACE)
    alike = np.eye(5)
    alike[:3, :3] = 1.0
    plain = estimate(surface, weights)
    scaled = estimate(surface, untrained_lightnet(tmp_path, Calibration(FACTORS, POWERS, alike)))
    assert scaled.rho_d == plain.rho_d
    made_true = FACTORS * (ward_stddev(plain) / USUAL.stddev) ** POWERS * USUAL.stddev
    np.testing.assert_allclose(ward_stddev(scaled), made_true)
    ward = np.array([*plain.rho_d, plain.rho_s, plain.alpha])
    np.testing.assert_allclose(
        scaled.lab_stddev, labcd_stddev(ward, ward_stddev(scaled), alike)[:3]
    )


@pytest.mark.parametrize("light", [None, LightMap().observed()])
def test_without_any_background_it_still_answers_and_says_so(weights, light):
    found = estimate(dataclasses.replace(SURFACE, light=light), weights)
    assert found.status is EstimateStatus.LOW_LIGHT
    assert found.status_text.startswith("none of the surroundings")
    assert (ward_stddev(found) >= USUAL.stddev).all()
    assert np.isfinite([*found.rho_d, found.rho_s, found.alpha]).all()


def test_a_little_of_the_light_is_low_and_a_lamp_is_clipped(weights):
    assert estimate(lit(SURFACE, seen=0.1), weights, low_light=0.3).status is (
        EstimateStatus.LOW_LIGHT
    )
    lamp = estimate(lit(SURFACE, lamp=True), weights)
    assert lamp.status is EstimateStatus.CLIPPED_LIGHT
    assert "lower the exposure" in lamp.status_text


def test_the_same_colours_under_stronger_light_are_of_a_darker_surface():
    surface = lit(sphere_surface(voxels=600))

    def albedo(strength):
        light = surface.light
        radiance = (strength * light.radiance).astype(np.float32)
        other = dataclasses.replace(surface, light=dataclasses.replace(light, radiance=radiance))
        return np.array(estimate(other, "").rho_d)

    dim, even, bright = map(albedo, (0.5, 1.0, 2.0))
    assert (dim > 2.0 * even).all()
    assert (even > 2.0 * bright).all()


def test_the_light_is_turned_upright_with_the_surface(weights):
    """Of a world that lies on its side the estimate is that of the upright one."""
    swap = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], np.float32)
    directions = np.random.default_rng(0).normal(size=(200_000, 3)).astype(np.float32)
    below = directions[directions[:, 2] < 0.0]
    standing, light = LightMap(), LightMap()
    # Dark at the horizon, where the two maps have other edges.
    downwards = -below[:, 2:] / np.linalg.norm(below, axis=1, keepdims=True)
    colours = np.repeat(np.uint8(240.0 * downwards), 3, axis=1)
    standing.add(below, colours)
    light.add(below @ swap.T, colours)
    surface = dataclasses.replace(SURFACE, light=standing.observed())
    lying = dataclasses.replace(
        surface,
        positions=surface.positions @ swap.T,
        normals=surface.normals @ swap.T,
        view_centres=surface.view_centres @ swap.T,
        light=light.observed(),
    )
    upright, raised = estimate(surface, weights), estimate(lying, weights, up=(0.0, -1.0, 0.0))
    forgotten = estimate(lying, weights)
    cost, error = (
        np.abs(np.subtract(other.rho_d, upright.rho_d)).max() for other in (forgotten, raised)
    )
    assert cost > 1e-3
    assert error < 0.1 * cost
    np.testing.assert_allclose(raised.rho_s_stddev, upright.rho_s_stddev, rtol=0.02)


def painted(colour):
    return sphere_surface(colour=lambda direction, normal: colour)


def from_one_view(surface):
    """Only what the first camera saw."""
    kept = surface.view_indices == 0
    voxel_of = np.repeat(np.arange(surface.voxel_count), surface.observation_counts)
    counts = np.bincount(voxel_of[kept], minlength=surface.voxel_count)
    return dataclasses.replace(
        surface,
        offsets=np.concatenate([[0], np.cumsum(counts)]),
        colours=surface.colours[kept],
        view_indices=surface.view_indices[kept],
    )


def one_lamp(colour):
    light = LightMap()
    light.add(np.array([[0.2, 0.1, 1.0]], np.float32), np.full((1, 3), colour, np.uint8))
    return light.observed()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "surface",
    [
        lit(painted((0, 0, 0))),
        lit(painted((255, 255, 255)), lamp=True),
        lit(from_one_view(SURFACE)),
        painted((0, 0, 0)),
        dataclasses.replace(SURFACE, light=one_lamp(0)),
        dataclasses.replace(SURFACE, light=one_lamp(255)),
        lit(without_observations(SURFACE, 10)),
    ],
    ids=["black", "white", "one view", "black in the dark", "dark light", "one lamp", "10 voxels"],
)
def test_odd_scans_give_finite_values_and_deviations(weights, surface):
    found = estimate(surface, weights)
    values = [*found.rho_d, found.rho_s, found.alpha, *found.lab, found.c, found.d]
    deviations = [*ward_stddev(found), *found.lab_stddev, found.c_stddev, found.d_stddev]
    assert np.isfinite(values).all()
    assert np.isfinite(deviations).all()
    assert min(deviations) >= 0.0


def test_assumed_light_makes_the_surface_of_usual_albedo():
    light = assumed_light(SURFACE)
    decoded = ((np.array([150, 120, 100]) / 255 + 0.055) / 1.055) ** 2.4
    assert decoded.mean() / light.radiance[0, 0, 0] == pytest.approx(0.25, rel=1e-4)
    assert 0.0 < light.coverage.max() < 0.01
