# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A structured-light camera in front of planes whose depth is known."""

import numpy as np
import pytest

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.synbrdf.realism.depth_holes import hole_probability
from reflest_core.synbrdf.realism.depth_sensor import BASELINE, DepthSensor

VGA = CameraIntrinsics(640, 480, 525.0, 525.0, 319.5, 239.5)
FACING = np.ones((480, 640), np.float32)


def plane(metres):
    return np.full((480, 640), metres, np.float32)


def rng():
    return np.random.default_rng(3)


def test_a_perfect_sensor_measures_the_truth():
    depth = plane(0.8)
    np.testing.assert_array_equal(DepthSensor(0.0, 0.0).measured(depth, FACING, VGA, rng()), depth)


@pytest.mark.parametrize("metres", [0.5, 1.0, 2.0, 3.0])
def test_noise_is_that_of_nguyen_and_quantisation_that_of_khoshelham(metres):
    measured = DepthSensor(1.0, 0.0).measured(plane(metres), FACING, VGA, rng())
    axial = 0.0012 + 0.0019 * (metres - 0.4) ** 2
    step = metres**2 / (525.0 * BASELINE) / 8
    expected = np.hypot(axial, step / 12**0.5)
    assert np.std(measured) == pytest.approx(expected, rel=0.1)
    assert np.mean(measured) == pytest.approx(metres, rel=0.002)
    eighths = 8 * 525.0 * BASELINE / measured
    np.testing.assert_allclose(eighths, np.rint(eighths), atol=1e-3)
    # Khoshelham & Elberink, Table 2: 2.85 mm at 1 m, with the square of the distance.
    assert step == pytest.approx(0.00285 * metres**2, rel=0.15)


def test_neighbours_err_alike():
    error = DepthSensor(1.0, 0.0).measured(plane(0.6), FACING, VGA, rng()) - 0.6
    beside = np.corrcoef(error[:, 1:].ravel(), error[:, :-1].ravel())[0, 1]
    apart = np.corrcoef(error[:, 8:].ravel(), error[:, :-8].ravel())[0, 1]
    assert beside > 0.5
    assert abs(apart) < 0.05


@pytest.mark.parametrize("degrees", [20.0, 70.0, 75.0, 85.0])
def test_grazed_surfaces_have_holes(degrees):
    cosines = np.full((480, 640), np.cos(np.deg2rad(degrees)), np.float32)
    measured = DepthSensor(0.0, 1.0).measured(plane(1.0), cosines, VGA, rng())
    expected = hole_probability(cosines)[0, 0]
    assert (measured == 0).mean() == pytest.approx(expected, abs=0.02)
    assert hole_probability(np.cos(np.deg2rad([75.0])))[0] == pytest.approx(0.5)


def test_the_projector_throws_a_shadow_on_one_side():
    near, far = 0.6, 1.0
    depth = plane(far)
    depth[100:300, 200:300] = near
    measured = DepthSensor(0.0, 1e-6).measured(depth, FACING, VGA, rng())
    lost = measured[150:250] == 0
    width = 525.0 * BASELINE * (1 / near - 1 / far)
    assert lost[:, 302 : 300 + int(width) - 2].all()
    assert lost.sum(axis=1).mean() == pytest.approx(width, abs=2.0)
    assert not lost[:, :200].any()


def test_edges_are_ragged_and_lossy():
    depth = plane(1.0)
    depth[:, 320:] = 0.5
    noisy = DepthSensor(1.0, 0.0).measured(depth, FACING, VGA, rng())
    border = (noisy < 0.75).argmax(axis=1)
    assert 0.3 < border.std() < 2.0
    holes = DepthSensor(0.0, 1.0).measured(depth, FACING, VGA, rng())
    assert (holes[:, 319:321] == 0).mean() == pytest.approx(0.5, abs=0.1)
    assert (holes[:, 10:300] == 0).mean() < 0.01


def test_where_nothing_is_nothing_is_measured():
    depth = plane(0.0)
    assert not DepthSensor(1.0, 1.0).measured(depth, FACING * 0, VGA, rng()).any()
