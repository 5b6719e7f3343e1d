# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Pictures are what the BRDF says, distances are 0 for equal ones, and the ranking follows."""

import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.brdf.sampling import specular_albedo
from reflest_core.evaluation.pictures import swatches
from reflest_core.evaluation.pictures.image_distance import image_distance
from reflest_core.evaluation.pictures.perception import measure_perception
from reflest_core.evaluation.pictures.rendered_shapes import bumpy_sphere, sphere
from reflest_core.evaluation.pictures.swatches import (
    EnvironmentSwatch,
    PointLightSwatch,
    point_light_directions,
)
from reflest_core.training.data.sample import Sample
from test.core.surfaces import sphere_surface

WHITE = np.ones((32, 64, 3), np.float32)


@pytest.fixture(autouse=True)
def _few_roughnesses(monkeypatch):
    monkeypatch.setattr(swatches, "ALPHAS", np.geomspace(0.05, 0.2, 3))


@pytest.mark.parametrize("shape", [sphere(), bumpy_sphere()])
def test_normals_face_the_camera_and_fit_the_mask(shape):
    assert shape.inside.sum() == len(shape.normals) > 2000
    np.testing.assert_allclose(np.linalg.norm(shape.normals, axis=1), 1, atol=1e-9)
    assert (shape.normals[:, 1] < 0).all()


def test_the_sphere_is_round():
    shape = sphere()
    across = np.cumsum(shape.inside.any(axis=0))[-1]
    assert across == pytest.approx(64 / 1.12, abs=2)
    assert shape.normals[:, 1].min() < -0.999


def test_in_a_white_room_a_matt_ball_shows_its_albedo():
    swatch = EnvironmentSwatch.prepare(sphere(), "white", WHITE)
    picture = swatch.picture(np.array([0.2, 0.5, 0.8, 0.0, 0.1]))
    expected = srgb.encode(np.array([0.2, 0.5, 0.8]) * swatch.exposure)
    np.testing.assert_allclose(picture[32, 32], expected, atol=5e-3)
    assert (picture[0, 0] == 0).all()


@pytest.mark.parametrize("alpha", [0.05, 0.07, 0.1])
def test_in_a_white_room_the_lobe_reflects_its_albedo(alpha):
    swatch = EnvironmentSwatch.prepare(sphere(), "white", WHITE)
    pixel = int(np.argmin(swatch.shape.normals[:, 1]))  # facing the camera
    place = np.interp(np.log(alpha), np.log(swatches.ALPHAS), np.arange(3))
    low = min(int(place), 1)
    glossy = (1 - (place - low)) * swatch.glossy[low] + (place - low) * swatch.glossy[low + 1]
    expected = specular_albedo(1.0, alpha, -swatch.shape.normals[pixel, 1:2])
    assert glossy[pixel].mean() == pytest.approx(expected[0], rel=0.02)


def test_the_point_light_moves_the_highlight():
    ward = np.array([0.05, 0.05, 0.05, 0.3, 0.1])
    centres = []
    for direction in point_light_directions():
        picture = PointLightSwatch.prepare(sphere(), "point light", direction).picture(ward)
        rows, columns = np.nonzero(picture[..., 0] > 0.9 * picture.max())
        centres.append((columns.mean() - 31.5, 31.5 - rows.mean()))
    for (x, z), direction in zip(centres, point_light_directions(), strict=True):
        assert np.sign(x) == np.sign(direction[0])
        assert np.sign(z) == np.sign(direction[2])


def test_equal_pictures_are_no_distance_apart_and_opposite_ones_far():
    picture = np.random.default_rng(0).random((64, 64, 3))
    same = image_distance(picture, picture)
    assert same.flip == 0
    assert same.ssim == pytest.approx(1)
    assert same.psnr > 50
    far = image_distance(np.zeros((64, 64, 3)), np.ones((64, 64, 3)))
    assert far.flip > 0.9
    assert far.psnr == pytest.approx(0, abs=1e-6)


def test_the_truth_is_ranked_first_and_the_worst_last():
    rng = np.random.default_rng(1)
    wards = np.concatenate([rng.uniform(0.1, 0.6, (4, 4)), rng.uniform(0.05, 0.2, (4, 1))], axis=1)
    samples = [Sample(sphere_surface(5, 5), ward, "", k) for k, ward in enumerate(wards)]
    lights = [
        EnvironmentSwatch.prepare(sphere(), "white", WHITE),
        PointLightSwatch.prepare(bumpy_sphere(), "point light 1", point_light_directions()[0]),
    ]
    estimates = {
        "hemicnn-rmse1": wards * 0.5,
        "grouplet-rmse1": wards,
        "hemicnn-rmse2": wards * 0.8,
    }
    measured = measure_perception(lights, samples, estimates)
    assert [row["variant"] for row in measured["rows"]] == [
        "grouplet-rmse1",
        "hemicnn-rmse2",
        "hemicnn-rmse1",
    ]
    assert measured["rows"][0]["flip"] == 0
    assert measured["rows"][0]["first"] == 1
    # The paper's users ranked these 2, 3 and 5: the same order.
    assert measured["rank_correlation"] == pytest.approx(1)
    assert set(measured["flip_by_light"]["hemicnn-rmse1"]) == {"white", "point light"}
