# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Poses as matrices: checked, normalised, interpolated; a bad one never becomes the identity."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.messages import PoseMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.parameter import ParameterError

# tf2 tolerates the same: beyond it the numbers are not a rotation that was rounded.
UNIT_TOLERANCE = 0.01
FURTHEST = 1e7
"""Metres; a position so far away is garbage. Map grids such as UTM lie within it."""


def check_pose(pose: PoseMessage, topic: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return (position (3,) metres, unit quaternion (4,) xyzw).

    Args:
        pose: position in metres and quaternion xyzw.
        topic: how sentences name the stream.

    Raises:
        FrameRefused: POSE_INVALID, on NaN, a far-off position or a quaternion that is not unit.
    """
    position = np.array(pose.position, dtype=np.float64)
    quaternion = np.array(pose.orientation, dtype=np.float64)
    at = f"pose on {topic} at {pose.stamp_ns / 1e9:.3f} s"
    if not (np.isfinite(position).all() and np.isfinite(quaternion).all()):
        raise FrameRefused(
            RefusalCause.POSE_INVALID,
            f"{at} holds NaN or infinity: check that the tracker has not lost its track",
        )
    if np.abs(position).max() >= FURTHEST:
        raise FrameRefused(
            RefusalCause.POSE_INVALID,
            f"{at} lies {FURTHEST:.0e} m or more from the origin: check the tracker's units",
        )
    norm = math.hypot(*quaternion)
    if abs(norm - 1.0) > UNIT_TOLERANCE:
        raise FrameRefused(
            RefusalCause.POSE_INVALID,
            f"{at} has a quaternion of norm {norm:.3g} instead of 1: check the pose's publisher",
        )
    return position, quaternion / norm


def pose_at(
    stamp_ns: int, before: PoseMessage, after: PoseMessage, topic: str
) -> NDArray[np.float64]:
    """Return the (4, 4) pose at ``stamp_ns``, between ``before`` and ``after`` (or at either).

    Positions are interpolated linearly, rotations along the shorter great arc.

    Args:
        stamp_ns: nanoseconds.
        before: the pose at or before the stamp.
        after: the pose at or after the stamp.
        topic: how sentences name the stream.

    Raises:
        FrameRefused: POSE_INVALID if either pose is.
    """
    start, start_rotation = check_pose(before, topic)
    end, end_rotation = check_pose(after, topic)
    if stamp_ns == before.stamp_ns:
        return rigid_matrix(start, start_rotation)
    if stamp_ns == after.stamp_ns:
        return rigid_matrix(end, end_rotation)
    fraction = (stamp_ns - before.stamp_ns) / (after.stamp_ns - before.stamp_ns)
    position = (1.0 - fraction) * start + fraction * end
    return rigid_matrix(position, _slerp(start_rotation, end_rotation, fraction))


def _slerp(
    start: NDArray[np.float64], end: NDArray[np.float64], fraction: float
) -> NDArray[np.float64]:
    cosine = float(start @ end)
    if cosine < 0.0:  # q and -q are one rotation: take the shorter way
        end, cosine = -end, -cosine
    angle = np.arccos(min(cosine, 1.0))
    if angle < 1e-6:
        mixed = (1.0 - fraction) * start + fraction * end
    else:
        mixed = np.sin((1.0 - fraction) * angle) * start + np.sin(fraction * angle) * end
    unit: NDArray[np.float64] = mixed / np.linalg.norm(mixed)
    return unit


def rigid_matrix(
    position: NDArray[np.float64], quaternion: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the (4, 4) matrix of a position (3,) and a unit quaternion (4,) xyzw.

    Args:
        position: (3,) metres.
        quaternion: (4,) unit, xyzw.
    """
    x, y, z, w = quaternion
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = position
    return matrix


def quaternion_of(rotation: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Return the quaternion xyzw of a (3, 3) matrix; NaN where the matrix is not a rotation.

    Args:
        rotation: (3, 3) matrix.
    """
    is_rotation = bool(np.abs(rotation).max() < 2.0) and (  # false for NaN, too
        np.abs(rotation @ rotation.T - np.eye(3)).max() < UNIT_TOLERANCE
        and np.linalg.det(rotation) > 0.0
    )
    if not is_rotation:
        return (np.nan, np.nan, np.nan, np.nan)
    # The eigenvector of Bar-Itzhack's symmetric matrix is stable for every rotation angle.
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation
    symmetric = np.array(
        [
            [xx - yy - zz, xy + yx, xz + zx, zy - yz],
            [xy + yx, yy - xx - zz, yz + zy, xz - zx],
            [xz + zx, yz + zy, zz - xx - yy, yx - xy],
            [zy - yz, xz - zx, yx - xy, xx + yy + zz],
        ]
    )
    x, y, z, w = np.linalg.eigh(symmetric)[1][:, -1].tolist()
    return (x, y, z, w)


def matrix_of_parameter(name: str, values: Sequence[float]) -> NDArray[np.float64]:
    """Return the (4, 4) matrix of a parameter that holds x, y, z and a quaternion x, y, z, w.

    Args:
        name: of the parameter, for sentences.
        values: of the parameter.

    Raises:
        ParameterError: if it is not seven finite numbers with a unit quaternion.
    """
    numbers = np.array(values, dtype=np.float64)
    if numbers.shape != (7,) or not np.isfinite(numbers).all():
        raise ParameterError(f"{name} = {tuple(values)} is not x, y, z and a quaternion x, y, z, w")
    norm = math.hypot(*numbers[3:])
    if abs(norm - 1.0) > UNIT_TOLERANCE:
        raise ParameterError(f"{name} has a quaternion of norm {norm:.3g} instead of 1")
    return rigid_matrix(numbers[:3], numbers[3:] / norm)
