# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Two albedos side by side are told from one albedo that is shaded unevenly."""

import numpy as np
import pytest

from reflest_core.inference.mixed_materials import two_albedos

RED, BLUE = np.array([0.5, 0.08, 0.06]), np.array([0.06, 0.1, 0.5])


def plane(count=400, seed=0):
    rng = np.random.default_rng(seed)
    return np.concatenate([rng.uniform(-0.1, 0.1, (count, 2)), np.zeros((count, 1))], axis=1), rng


def divided(albedo, positions, rng, shading=0.1):
    irradiance = np.exp(rng.normal(0.0, 0.2, (len(positions), 1)))
    error = np.exp(rng.normal(0.0, shading, (len(positions), 1)))
    return two_albedos(
        positions.astype(np.float32),
        (albedo * irradiance * error).astype(np.float32),
        np.broadcast_to(irradiance, albedo.shape).astype(np.float32),
    )


@pytest.mark.parametrize("share", [0.1, 0.5])
def test_two_halves_are_two(share):
    positions, rng = plane()
    is_second = positions[:, 0] < np.quantile(positions[:, 0], share)
    found = divided(np.where(is_second[:, None], RED, BLUE), positions, rng)
    assert found.is_mixed
    assert found.share == pytest.approx(share, abs=0.02)


@pytest.mark.parametrize("shading", [0.0, 0.1, 0.4])
def test_one_albedo_is_one_however_it_is_shaded(shading):
    positions, rng = plane()
    found = divided(np.broadcast_to(RED, positions.shape), positions, rng, shading)
    assert found is None or not found.is_mixed


def test_a_gradient_of_light_is_no_second_material():
    positions, rng = plane()
    albedo = RED * np.exp(6.0 * positions[:, :1])
    assert not divided(albedo, positions, rng).is_mixed


def test_light_that_is_wrong_on_one_side_is_no_second_material():
    positions, _ = plane()
    colours = np.full(positions.shape, 0.2, np.float32)
    irradiance = np.where(positions[:, :1] > 0.0, 0.3, 1.0).repeat(3, axis=1)
    found = two_albedos(positions.astype(np.float32), colours, irradiance.astype(np.float32))
    assert found.distance > 12.0
    assert not found.is_mixed


def test_scattered_colours_are_a_texture():
    positions, rng = plane()
    albedo = np.where(rng.uniform(size=(len(positions), 1)) < 0.4, RED, BLUE)
    assert not divided(albedo, positions, rng).is_mixed


def test_few_voxels_say_nothing():
    positions, rng = plane(20)
    assert divided(np.broadcast_to(RED, positions.shape), positions, rng) is None
