# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from reflest_core.fusion.keyframe import KeyframePolicy, rotation_angle
from reflest_core.fusion.settings import KeyframeSettings

SETTINGS = KeyframeSettings(translation=0.1, rotation=10.0, interval=1.0)
SECOND = 1_000_000_000


def pose(x=0.0, degrees=0.0):
    T = np.eye(4)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    T[:2, :2] = [[c, -s], [s, c]]
    T[0, 3] = x
    return T


@pytest.mark.parametrize(
    ("stamp_ns", "T", "expected"),
    [
        (SECOND // 2, pose(0.09, 9.0), False),
        (SECOND // 2, pose(0.11), True),
        (SECOND // 2, pose(0.0, 11.0), True),
        (SECOND // 2, pose(0.0, -170.0), True),
        (SECOND, pose(), True),
    ],
)
def test_movement_rotation_or_time_makes_a_keyframe(stamp_ns, T, expected):
    policy = KeyframePolicy(SETTINGS)
    assert policy.is_keyframe(0, pose())
    assert policy.is_keyframe(stamp_ns, T) is expected


def test_movement_counts_from_the_last_keyframe_not_the_last_frame():
    policy = KeyframePolicy(SETTINGS)
    steps = [policy.is_keyframe(n, pose(0.04 * n)) for n in range(8)]
    assert steps == [True, False, False, True, False, False, True, False]


def test_pose_is_copied():
    policy = KeyframePolicy(SETTINGS)
    T = pose()
    policy.is_keyframe(0, T)
    T[0, 3] = 5.0
    assert not policy.is_keyframe(1, pose())


def test_reset_makes_the_next_frame_a_keyframe():
    policy = KeyframePolicy(SETTINGS)
    policy.is_keyframe(0, pose())
    policy.reset()
    assert policy.is_keyframe(1, pose())


@pytest.mark.parametrize("degrees", [0.0, 1e-4, 45.0, 179.999])
def test_rotation_angle(degrees):
    assert rotation_angle(pose(degrees=degrees)[:3, :3]) == pytest.approx(degrees, abs=1e-9)


def test_rotation_angle_of_a_half_turn():
    assert rotation_angle(np.diag([1.0, -1.0, -1.0])) == pytest.approx(180.0)
