# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from reflest_core.fusion.frames.slant import FULL_WEIGHT, find_steepness
from test.core.fusion.analytic_scene import SMALL_CAMERA


@pytest.mark.parametrize("normal", [(0.0, 0.0, -1.0), (0.3, -0.5, -0.8), (-0.8, 0.1, -0.6)])
def test_plane_gives_the_cosine_of_its_viewing_angle(normal):
    normal = np.array(normal) / np.linalg.norm(normal)
    v, u = np.mgrid[: SMALL_CAMERA.height, : SMALL_CAMERA.width].astype(np.float64)
    camera = SMALL_CAMERA
    rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones_like(u)], -1)
    depth = (normal @ [0.0, 0.0, 2.0]) / (rays @ normal)
    shown = (depth > 0.5) & (depth < 4.0)
    shown[:2] = shown[-2:] = shown[:, :2] = shown[:, -2:] = False
    steepness = np.empty(depth.shape, np.float32)
    gain = np.empty(depth.shape, np.uint8)
    find_steepness(
        0, len(depth), depth.astype(np.float32), shown, 2, camera.matrix, steepness, gain
    )
    cosine = -(rays @ normal) / np.linalg.norm(rays, axis=-1)
    steep = shown & (cosine > 0.2)
    found = steepness[steep] / np.linalg.norm(rays, axis=-1)[steep]
    assert np.all(steepness[~shown] == 0.0)
    assert np.all(gain[~shown] == 0)
    np.testing.assert_allclose(found, cosine[steep], atol=0.03)
    np.testing.assert_allclose(gain[steep], FULL_WEIGHT * cosine[steep] ** 2, atol=1.5)
