# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Poses: known rotations, round trips, interpolation, and refusals instead of the identity."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from reflest_core.capture.messages import PoseMessage
from reflest_core.capture.pose import (
    check_pose,
    matrix_of_parameter,
    pose_at,
    quaternion_of,
    rigid_matrix,
)
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.parameter import ParameterError

unit_quaternions = (
    st.tuples(*[st.floats(-1, 1)] * 4)
    .map(np.array)
    .filter(lambda q: np.linalg.norm(q) > 0.1)
    .map(lambda q: q / np.linalg.norm(q))
)


def pose(stamp_ns=0, position=(1.0, 2.0, 3.0), orientation=(0.0, 0.0, 0.0, 1.0)):
    return PoseMessage(stamp_ns, "world", tuple(position), tuple(orientation))


@given(unit_quaternions)
def test_the_rotation_equals_scipys(quaternion):
    matrix = rigid_matrix(np.array([1.0, 2.0, 3.0]), quaternion)
    assert np.allclose(matrix[:3, :3], Rotation.from_quat(quaternion).as_matrix(), atol=1e-12)
    assert matrix[:3, 3].tolist() == [1.0, 2.0, 3.0]


@given(unit_quaternions)
def test_matrix_to_quaternion_and_back(quaternion):
    matrix = Rotation.from_quat(quaternion).as_matrix()
    again = rigid_matrix(np.zeros(3), np.array(quaternion_of(matrix)))[:3, :3]
    assert np.allclose(again, matrix, atol=1e-9)


@pytest.mark.parametrize(
    "matrix", [np.full((3, 3), np.nan), np.diag([1.0, 1.0, -1.0]), 2 * np.eye(3), np.zeros((3, 3))]
)
def test_what_is_no_rotation_has_no_quaternion(matrix):
    assert np.isnan(quaternion_of(matrix)).all()


def test_a_slightly_rounded_quaternion_is_normalised():
    _, quaternion = check_pose(pose(orientation=(0.0, 0.0, 0.0, 1.005)), "/pose")
    assert quaternion.tolist() == [0.0, 0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("fields", "word"),
    [
        ({"position": (math.nan, 0.0, 0.0)}, "NaN"),
        ({"position": (0.0, math.inf, 0.0)}, "NaN or infinity"),
        ({"orientation": (math.nan, 0.0, 0.0, 1.0)}, "NaN"),
        ({"orientation": (0.0, 0.0, 0.0, 0.0)}, "norm 0 "),
        ({"orientation": (0.0, 0.0, 0.0, 1.1)}, "norm 1.1 "),
        ({"orientation": (1e200, 0.0, 0.0, 1.0)}, "norm"),
        ({"position": (1e7, 0.0, 0.0)}, "units"),
    ],
)
def test_a_bad_pose_is_refused_with_the_reason(fields, word):
    with pytest.raises(FrameRefused, match="/pose") as refused:
        check_pose(pose(**fields), "/pose")
    assert refused.value.cause is RefusalCause.POSE_INVALID
    assert word in str(refused.value)


@given(st.tuples(*[st.floats()] * 7))
def test_any_numbers_give_a_rigid_matrix_or_a_refusal(values):
    message = pose(position=values[:3], orientation=values[3:])
    try:
        matrix = pose_at(0, message, message, "/pose")
    except FrameRefused as refusal:
        assert refusal.cause is RefusalCause.POSE_INVALID
        return
    assert np.allclose(matrix[:3, :3] @ matrix[:3, :3].T, np.eye(3), atol=1e-9)


@given(unit_quaternions, unit_quaternions, st.integers(0, 1000))
def test_interpolation_equals_scipys_slerp(start, end, at):
    if abs(start @ end) < 0.01:
        return  # half a turn apart: either way round is right
    before, after = pose(0, (0.0, 0.0, 0.0), start), pose(1000, (1.0, -2.0, 4.0), end)
    matrix = pose_at(at, before, after, "/pose")
    slerp = Slerp([0, 1000], Rotation.from_quat([start, end]))(at)
    assert np.allclose(matrix[:3, :3], slerp.as_matrix(), atol=1e-5)
    assert np.allclose(matrix[:3, 3], np.array([1.0, -2.0, 4.0]) * at / 1000)


def test_either_bad_end_spoils_the_interpolation():
    good, bad = pose(0), pose(10, orientation=(math.nan,) * 4)
    for pair in [(good, bad), (bad, good)]:
        with pytest.raises(FrameRefused):
            pose_at(5, *pair, "/pose")


@pytest.mark.parametrize(
    "values", [(0.0,) * 7, (0.0,) * 6, (math.nan, 0, 0, 0, 0, 0, 1), (0, 0, 0, 0, 0, 0, 2)]
)
def test_a_bad_pose_to_camera_is_a_parameter_error(values):
    with pytest.raises(ParameterError, match="pose_to_camera"):
        matrix_of_parameter("pose_to_camera", values)
