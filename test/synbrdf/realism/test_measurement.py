# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What realism's constants are measured with, on scans small enough for a test."""

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

pytest.importorskip("mitsuba")

from reflest_core.synbrdf.measurement.fusion_error import FusionError, measure
from reflest_core.synbrdf.measurement.jpeg_error import jpeg_error
from reflest_core.synbrdf.measurement.shading_error import shading_error
from reflest_core.synbrdf.realism.depth_sensor import DepthSensor
from reflest_core.synbrdf.realism.jpeg import compression_error
from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.synbrdf.sequences.sequence_scene import SequenceRequest
from test.synbrdf.spheres import icosphere

SCAN = SequenceRequest(seed=1, frames=12, width=320, height=240, shape="superquadric")
STILL = Realism.only([])


def test_a_kinects_depth_tilts_fused_normals():
    exact = measure(SCAN, DepthSensor(0.0, 0.0), STILL, 0.008).quantiles()
    noisy = measure(SCAN, DepthSensor(1.0, 1.0), STILL, 0.008).quantiles()
    assert exact["tilt_median"] < 1.5
    assert noisy["tilt_median"] > 1.5 * exact["tilt_median"]
    assert exact["offset_stddev"] < 2e-4 < noisy["offset_stddev"]


def test_wrong_poses_move_the_surface():
    exact = measure(SCAN, DepthSensor(0.0, 0.0), STILL, 0.008).quantiles()
    moved = measure(SCAN, DepthSensor(0.0, 0.0), Realism.only([Effect.POSE]), 0.008).quantiles()
    assert moved["offset_stddev"] > 3 * exact["offset_stddev"]


def test_shading_is_compared_with_triangles():
    ball = icosphere(4)
    error, areas = shading_error(ball)
    assert error.max() < 0.5
    assert areas.sum() == pytest.approx(4 * np.pi, rel=0.01)
    tilted = Rotation.from_euler("x", 12.0, degrees=True).as_matrix()
    turned = dataclasses.replace(ball, normals=ball.normals @ tilted.T)
    assert shading_error(turned)[0].max() == pytest.approx(12.0, abs=0.5)


def test_errors_are_joined():
    one = FusionError(np.array([1.0, 3.0]), np.zeros(2))
    assert FusionError.joined([one, one]).quantiles()["tilt_median"] == 2.0


@pytest.mark.parametrize("quality", [60, 90])
def test_lone_pixels_err_as_the_codec_makes_them(quality):
    """On a shaded, slightly noisy ball before a busy background."""
    rng = np.random.default_rng(0)
    v, u = np.indices((240, 320))
    mask = (u - 160) ** 2 + (v - 120) ** 2 < 80**2
    shade = 60 + 0.5 * u + 0.2 * v
    image = np.where(mask, shade, 40 + 150 * ((u // 9 + v // 7) % 2))[..., None]
    image = image * [0.9, 0.7, 0.5] + rng.normal(0, 4, (240, 320, 3))
    image = np.clip(image, 0, 255).astype(np.uint8)
    codec = jpeg_error([(image, mask)], quality)
    red, green, blue = compression_error(20_000, quality, rng).T
    luma = (0.299 * red + 0.587 * green + 0.114 * blue).std()
    assert codec[0] / 2.5 < luma < codec[0] * 2.5
