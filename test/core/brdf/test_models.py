# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Every model keeps the one protocol."""

import math

import numpy as np
import pytest

from reflest_core.brdf.models import MODELS, Ward
from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.brdf.sampling import specular_albedo
from reflest_core.brdf.ward import evaluate

MATERIAL = np.array([0.5, 0.3, 0.1, 0.2, 0.3])


@pytest.fixture(params=list(MODELS), name="model")
def _model(request):
    return MODELS[request.param]


def hemisphere(rows=400, columns=400):
    """Directions at midpoints of cells of equal projected solid angle, whose sum is pi."""
    radius = np.sqrt((np.arange(rows) + 0.5) / rows)[:, None]
    turn = 2 * math.pi * (np.arange(columns) + 0.5) / columns
    z = np.sqrt(1 - radius**2) * np.ones_like(turn)
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), z], -1).reshape(-1, 3)


def test_a_model_is_found_by_its_name_and_names_its_values(model):
    assert MODELS[model.name] is model
    assert len({one.name for one in model.parameters}) == len(MATERIAL)
    values = zip(model.parameters, MATERIAL, strict=True)
    assert all(one.lowest <= value <= one.highest for one, value in values)


@pytest.mark.parametrize("cosine", [1.0, 0.7, 0.4])
def test_the_albedo_is_the_integral_of_the_brdf(model, cosine):
    omega_o = np.array([math.sqrt(1 - cosine**2), 0.0, cosine])
    value = model.evaluate(MATERIAL, hemisphere(), omega_o)
    found = model.albedo(MATERIAL, np.array([cosine]))[0]
    np.testing.assert_allclose(found, math.pi * value.mean(axis=0), rtol=0.02)


def test_light_and_camera_may_be_exchanged(model):
    omega_i, omega_o = np.array([0.6, 0.0, 0.8]), np.array([0.0, -0.28, 0.96])
    np.testing.assert_allclose(
        model.evaluate(MATERIAL, omega_i, omega_o), model.evaluate(MATERIAL, omega_o, omega_i)
    )


def test_nothing_is_reflected_below_the_surface(model):
    below, up = np.array([0.6, 0.0, -0.8]), np.array([0.0, 0.0, 1.0])
    assert not model.evaluate(MATERIAL, below, up).any()
    assert not model.evaluate(MATERIAL, up, below).any()


def test_samples_estimate_the_lobe_over_any_light(model):
    """A light that is brighter on one side, by samples and by a sum over the hemisphere."""
    omega_o = np.array([0.5, 0.0, math.sqrt(0.75)])
    u = np.random.default_rng(5).random((200_000, 2))
    omega_i, weights = model.sample(MATERIAL, omega_o, u)
    sampled = np.mean(weights * (1.0 + omega_i[:, 0]))
    matt = MATERIAL.copy()
    matt[3] = 0.0
    directions = hemisphere()
    whole = model.evaluate(MATERIAL, directions, omega_o)[:, 0]
    if isinstance(MODELS[model.name], Ward):
        whole = whole - model.evaluate(matt, directions, omega_o)[:, 0]
    else:
        black = MATERIAL * (0, 0, 0, 1, 1)
        whole = model.evaluate(black, directions, omega_o)[:, 0]
    assert sampled == pytest.approx(math.pi * np.mean(whole * (1.0 + directions[:, 0])), rel=0.02)


@pytest.mark.parametrize("variant", list(WardVariant))
def test_ward_is_the_functions_to_the_bit(variant):
    model, directions = Ward(variant), hemisphere(20, 20)
    omega_o = np.array([0.6, 0.0, 0.8])
    material = WardParameters((0.5, 0.3, 0.1), 0.2, 0.3, variant)
    assert material.vector == tuple(MATERIAL)
    np.testing.assert_array_equal(
        model.evaluate(MATERIAL, directions, omega_o),
        evaluate(MATERIAL[:3], MATERIAL[3], MATERIAL[4], directions, omega_o, variant),
    )
    cosines = np.array([0.9, 0.5])
    np.testing.assert_array_equal(
        model.albedo(MATERIAL, cosines),
        MATERIAL[:3] + specular_albedo(0.2, 0.3, cosines, variant)[:, None],
    )
