# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reflest_core.synbrdf.scenes.views import draw_views, look_at
from reflest_core.synbrdf.sequences.trajectory import hand_held_orbit


def assert_rigid(poses):
    rotation = poses[:, :3, :3]
    identity = np.broadcast_to(np.eye(3), rotation.shape)
    np.testing.assert_allclose(rotation @ rotation.transpose(0, 2, 1), identity, atol=1e-9)
    np.testing.assert_allclose(np.linalg.det(rotation), 1.0)


def test_look_at_is_an_optical_frame():
    pose = look_at(np.array([2.0, 0.0, 0.0]), np.zeros(3))
    np.testing.assert_allclose(pose[:3, 2], [-1, 0, 0], atol=1e-12)  # forward
    np.testing.assert_allclose(pose[:3, 1], [0, 0, -1], atol=1e-12)  # down
    np.testing.assert_allclose(pose[:3, 0], [0, 1, 0], atol=1e-12)  # right
    np.testing.assert_allclose(pose[:3, 3], [2, 0, 0])
    assert_rigid(look_at(np.array([0.0, 0.0, 3.0]), np.zeros(3))[None])


@settings(max_examples=40)
@given(st.integers(0, 2**32), st.floats(0.15, 0.5))
def test_sparse_views_stay_outside_and_look_at_the_object(seed, diameter):
    poses, _ = draw_views(np.random.default_rng(seed), 30, diameter)
    assert_rigid(poses)
    distance = np.linalg.norm(poses[:, :3, 3], axis=1)
    assert distance.min() >= min(0.5, 1.2 * diameter) - 1e-9
    assert distance.max() <= 1.6 + 1e-9
    off_axis = np.linalg.norm(np.cross(-poses[:, :3, 3], poses[:, :3, 2]), axis=1)
    assert off_axis.max() < 0.6 * diameter


@settings(max_examples=40)
@given(st.integers(0, 2**32), st.floats(0.2, 0.36))
def test_a_hand_goes_well_round_at_varied_heights(seed, diameter):
    poses = hand_held_orbit(np.random.default_rng(seed), 60, diameter)
    assert_rigid(poses)
    x, y, z = poses[:, :3, 3].T
    azimuth = np.unwrap(np.arctan2(y, x))
    assert 270 <= abs(np.rad2deg(azimuth[-1] - azimuth[0])) <= 420
    elevation = np.rad2deg(np.arctan2(z, np.hypot(x, y)))
    assert 9.9 <= elevation.min() < 25
    assert 45 < elevation.max() <= 60.1
    distance = np.linalg.norm(poses[:, :3, 3], axis=1)
    assert distance.min() >= 0.4
    assert distance.max() <= 0.8 + 1e-9
    assert distance.min() > 1.2 * diameter
    # Smooth: no step turns the camera by more than 15 degrees.
    turns = np.einsum("nij,nij->n", poses[1:, :3, :3], poses[:-1, :3, :3])
    assert np.rad2deg(np.arccos(np.clip((turns - 1) / 2, -1, 1))).max() < 15


@pytest.mark.parametrize("draw", [draw_views, hand_held_orbit])
def test_the_same_generator_gives_the_same_path(draw):
    one, other = (draw(np.random.default_rng(8), 20, 0.3) for _ in range(2))
    if draw is draw_views:
        one, other = one[0], other[0]
    np.testing.assert_array_equal(one, other)
