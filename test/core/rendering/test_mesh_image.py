# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Drawn meshes: where a triangle falls, what hides what, and where pixels look."""

import numpy as np
import pytest

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.rendering.mesh_image import mesh_image, ray_directions

CAMERA = CameraIntrinsics(40, 30, 50.0, 50.0, 19.5, 14.5)
POSE = np.eye(4)
RED, BLUE = (200, 0, 0), (0, 0, 200)


def square(half, depth, colour):
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], np.float32) * half
    vertices = np.column_stack([corners, np.full(4, depth, np.float32)])
    return vertices, np.array([[0, 1, 2], [0, 2, 3]], np.int32), np.tile(np.uint8(colour), (4, 1))


def drawn(*squares, scale=1):
    vertices = np.concatenate([one[0] for one in squares])
    faces = np.concatenate([one[1] + 4 * k for k, one in enumerate(squares)])
    colours = np.concatenate([one[2] for one in squares])
    background = np.full((30 * scale, 40 * scale, 3), 9, np.uint8)
    return mesh_image(vertices, faces, colours, background, CAMERA, POSE)


@pytest.mark.parametrize("scale", [1, 3])
def test_a_square_covers_the_pixels_that_its_projection_covers(scale):
    # 0.2 m half edge at 1 m and 50 pixels focal length: 10 pixels on each side of (19.5, 14.5).
    image = drawn(square(0.2, 1.0, RED), scale=scale)
    rows, columns = np.nonzero(image[..., 0] > 100)
    assert abs((columns.max() + 1) / scale - 30) <= 1 / scale
    assert abs(columns.min() / scale - 10) <= 1 / scale
    assert abs((rows.max() + 1) / scale - 25) <= 1 / scale
    assert abs(rows.min() / scale - 5) <= 1 / scale
    assert (image[0, 0] == 9).all()


def test_the_nearer_surface_hides_the_farther_one_in_any_order():
    near, far = square(0.1, 1.0, RED), square(0.5, 2.0, BLUE)
    image = drawn(near, far)
    assert tuple(image[15, 20]) == RED
    assert tuple(image[15, 29]) == BLUE
    np.testing.assert_array_equal(image, drawn(far, near))


def test_what_lies_behind_the_camera_is_not_drawn():
    assert (drawn(square(0.5, -1.0, RED)) == 9).all()


def test_rays_of_a_scaled_image_meet_the_points_that_the_camera_sees_there():
    pose = np.eye(4)
    pose[:3, :3] = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]
    rays = ray_directions(CAMERA, pose, 60, 80)
    assert np.allclose(np.linalg.norm(rays, axis=-1), 1.0)
    # The middle of the image looks along the optical axis, which is the world's x here.
    np.testing.assert_allclose(rays[29:31, 39:41].mean(axis=(0, 1)), [1, 0, 0], atol=1e-4)
    # Pixel 0 of the scaled image lies a quarter pixel left of the camera's first.
    x = (-0.25 - 19.5) / 50.0
    np.testing.assert_allclose(rays[30, 0, 1] / rays[30, 0, 0], -x, rtol=1e-6)
