# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Hemisphere images: where an observation lands, nearest-neighbour fill, the azimuth origin."""

import dataclasses
import math

import numpy as np
import pytest

from reflest_core.models.hemicnn.hemisphere_images import SIZE, hemisphere_images
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.tangent_frame import tangent_frame


def one_voxel(normal, directions, colours):
    """A voxel at the origin seen from 1 m along each direction."""
    count = len(directions)
    return ObservedSurface(
        positions=np.zeros((1, 3), np.float32),
        normals=np.array([normal], np.float32),
        offsets=np.array([0, count]),
        colours=np.array(colours, np.uint8),
        view_indices=np.arange(count, dtype=np.uint16),
        view_centres=np.array(directions, np.float32),
        view_foreground=np.zeros((count, 3), np.float32),
        view_background=np.zeros((count, 3), np.float32),
    )


VOXEL = np.array([0])
RED, BLUE = (255, 0, 0), (0, 0, 255)


def test_one_observation_fills_the_image_with_its_colour():
    image = hemisphere_images(one_voxel((0, 0, 1), [(0, 0, 1)], [(51, 102, 255)]), VOXEL)
    assert image.shape == (1, 3, SIZE, SIZE)
    np.testing.assert_allclose(image[0], np.broadcast_to([[[0.2]], [[0.4]], [[1.0]]], (3, 10, 10)))


def test_a_pixel_takes_the_nearest_observation_and_up_is_the_azimuth_origin():
    # A wall facing +x: the tangent (columns) is world up, seen from above (red) and below (blue).
    above, below = (0.8, 0, 0.6), (0.8, 0, -0.6)
    image = hemisphere_images(one_voxel((1, 0, 0), [above, below], [RED, BLUE]), VOXEL)[0]
    assert (image[0, :, 5:] == 1).all()
    assert (image[2, :, :5] == 1).all()
    turned = hemisphere_images(
        one_voxel((1, 0, 0), [above, below], [RED, BLUE]), VOXEL, np.array([math.pi / 2])
    )[0]
    assert (turned[0, 5:, :] == 1).all()
    assert (turned[2, :5, :] == 1).all()


def test_an_observation_from_behind_does_not_count():
    surface = one_voxel((0, 0, 1), [(0.6, 0, -0.8), (0, 0.6, 0.8)], [RED, BLUE])
    assert (hemisphere_images(surface, VOXEL)[0, 2] == 1).all()
    behind = dataclasses.replace(surface, normals=np.array([[0, 0, -1]], np.float32))
    assert (hemisphere_images(behind, VOXEL)[0, 0] == 1).all()


def test_a_voxel_seen_only_from_behind_is_black():
    assert not hemisphere_images(one_voxel((0, 0, 1), [(0, 0, -1)], [RED]), VOXEL).any()


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0.48, 0.6, 0.64)])
def test_tangent_frame_is_right_handed_and_orthonormal(normal):
    normal = np.array(normal, np.float32)
    frame = np.array(tangent_frame(normal)).reshape(2, 3)
    axes = np.vstack([frame, normal])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-6)
    assert np.linalg.det(axes) == pytest.approx(1, abs=1e-6)
