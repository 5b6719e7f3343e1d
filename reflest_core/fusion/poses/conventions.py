# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The usual mistakes in poses, depth and intrinsics, tried on pairs of frames that do not meet."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.pose import quaternion_of, rigid_matrix
from reflest_core.fusion.poses.agreement import Agreement, DepthSample

Matrix = NDArray[np.float64]
Pair = tuple[DepthSample, DepthSample]

GOOD_SHARE = 0.75
"""A convention fits where pairs agree to this share under it."""
GAIN = 0.15
"""It is named where it raises the share by at least this much."""
SCALES = (1000.0, 100.0, 10.0, 5.0, 4.0, 3.28084, 2.5, 2.0, 1.6, 1.25)
"""Factors between units, and some in between for trackers of unknown scale."""
FOCAL_SCALES = (4.0, 3.0, 2.0, 1.5, 1.333)
"""Between the resolutions that cameras offer."""

OPTICAL_IN_BODY: Matrix = np.array(
    [[0.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)
"""The optical frame (z forward, y down) in a body frame (x forward, z up; REP 103)."""
OPTICAL_IN_OPENGL: Matrix = np.diag([1.0, -1.0, -1.0, 1.0])
"""The optical frame in an OpenGL camera's (z backwards, y up)."""


@dataclass(frozen=True)
class Convention:
    """A reading of poses, depth and intrinsics other than this package's own.

    Attributes:
        sentence: What the poses or the depth seem to be, and what to change.
        pose: From a pose as it came, (4, 4), to the optical frame's ``T_world_camera``.
        focal: Factor on the focal lengths.
    """

    sentence: str
    pose: Callable[[Matrix], Matrix]
    focal: float = 1.0


def _inverse(pose: Matrix) -> Matrix:
    return np.asarray(np.linalg.inv(pose), np.float64)


def _mirrored(axis: int) -> Callable[[Matrix], Matrix]:
    mirror = np.eye(4)
    mirror[axis, axis] = -1.0
    return lambda pose: mirror @ pose @ mirror


def _scaled(factor: float) -> Callable[[Matrix], Matrix]:
    scale = np.ones((4, 4))
    scale[:3, 3] = factor
    return lambda pose: pose * scale


def _reordered(pose: Matrix) -> Matrix:
    """Read the quaternion's components as w, x, y, z."""
    x, y, z, w = quaternion_of(pose[:3, :3])
    return rigid_matrix(pose[:3, 3], np.array([y, z, w, x]))


def _conventions() -> Iterator[Convention]:
    in_body = (
        "the poses seem to be those of the camera's body frame (x forward, as camera_link), not of "
        "its optical frame (z forward): set capture.pose_to_camera to 0, 0, 0, -0.5, 0.5, -0.5, 0.5"
    )
    in_opengl = (
        "the poses seem to be those of an OpenGL camera (z backwards, y up), not of an optical "
        "frame (z forward, y down): set capture.pose_to_camera to 0, 0, 0, 1, 0, 0, 0"
    )
    inverse = "the poses seem to be world-to-camera: invert them, the pose of the camera is wanted"
    yield Convention(in_body, lambda pose: pose @ OPTICAL_IN_BODY)
    yield Convention(in_opengl, lambda pose: pose @ OPTICAL_IN_OPENGL)
    yield Convention(inverse, _inverse)
    yield Convention(
        "the poses seem to be world-to-camera, of the camera's body frame (x forward): invert "
        "them, and set capture.pose_to_camera to 0, 0, 0, -0.5, 0.5, -0.5, 0.5",
        lambda pose: _inverse(pose) @ OPTICAL_IN_BODY,
    )
    for axis, name in enumerate("xyz"):
        yield Convention(
            f"the poses seem to be mirrored along {name} (a left-handed world, as game engines "
            "have): convert them to a right-handed one",
            _mirrored(axis),
        )
    yield Convention(
        "the quaternions seem to be in the order w, x, y, z: give them as x, y, z, w", _reordered
    )
    yield Convention(
        "the poses seem to be OpenGL view matrices (world-to-camera, z backwards): invert them, "
        "and set capture.pose_to_camera to 0, 0, 0, 1, 0, 0, 0",
        lambda pose: _inverse(OPTICAL_IN_OPENGL @ pose),
    )
    yield Convention(
        "the rotations seem to be transposed: give the camera's axes in the world as columns",
        _transposed,
    )
    for scale in SCALES:
        for factor, fits in (
            (scale, f"{scale:g} times longer"),
            (1 / scale, f"{scale:g} times shorter"),
        ):
            yield Convention(
                "the poses' positions and the depth seem to be in different units: positions "
                f"{fits} fit the depth; check the tracker's unit (metres are wanted) and "
                "capture.depth_scale",
                _scaled(factor),
            )
    for scale in FOCAL_SCALES:
        for factor, fits in ((scale, "longer"), (1 / scale, "shorter")):
            yield Convention(
                f"the focal lengths seem wrong: {scale:g} times {fits} ones fit the depth; check "
                "that camera_info is of the images' resolution",
                lambda pose: pose,
                factor,
            )


def _transposed(pose: Matrix) -> Matrix:
    turned = pose.copy()
    turned[:3, :3] = pose[:3, :3].T
    return turned


CONVENTIONS = tuple(_conventions())


def likely_convention(pairs: Sequence[Pair], given: float) -> str:
    """Return the sentence of the convention under which the pairs meet, or "".

    Args:
        pairs: An earlier and a later frame each.
        given: Share of agreement under the poses as they came.

    Returns:
        The best convention's sentence, where it explains the pairs; else "".
    """
    best, sentence = max(GOOD_SHARE, given + GAIN), ""
    for convention in CONVENTIONS:
        shares = sorted(
            agreement.share
            for earlier, later in pairs
            if (agreement := _under(convention, earlier, later)).is_known
        )
        if 2 * len(shares) > len(pairs) and shares[len(shares) // 2] > best:
            best, sentence = shares[len(shares) // 2], convention.sentence
    return sentence


def _under(convention: Convention, earlier: DepthSample, later: DepthSample) -> Agreement:
    try:
        relative = np.linalg.inv(convention.pose(earlier.pose)) @ convention.pose(later.pose)
    except np.linalg.LinAlgError:
        return Agreement(0.0, 1.0, 0)
    return later.meets(earlier, relative, focal=convention.focal)
