# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The usual mistakes in poses, depth and intrinsics, tried on pairs of frames that do not meet."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.pose import quaternion_of, rigid_matrix
from reflest_core.fusion.frames.depth_unit import mistake_of
from reflest_core.fusion.poses.agreement import SAMPLES, Agreement, DepthSample

Matrix = NDArray[np.float64]
Pair = tuple[DepthSample, DepthSample]

GOOD_SHARE = 0.75
"""A convention fits where pairs agree to this share under it."""
GAIN = 0.15
"""It is named where it raises the share by at least this much."""
FEW_SAMPLES, NOT_FAR = 300, 0.15
"""Conventions are tried on so many samples of a frame first; those that lack more than the second
share to fit are not tried on all."""
FACTOR_SHARE, FACTOR_PAIRS, FACTOR_MARGIN = 0.9, 4, 0.05
"""A factor near one makes many wrong depth maps meet better than they did. It fits where every one
of so many pairs agrees to this share, as under right poses; and is named where it exceeds every
explanation of another kind by this margin."""
NEAR_FACTOR = 4.0
"""Factors up to this one are near one. Units are further apart."""
SCALES = (1000.0, 100.0, 10.0, 5.0, 4.0, 3.28084, 2.5, 2.0, 1.6, 1.25, 1.1)
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
        scale: Factor on the positions.
    """

    sentence: str
    pose: Callable[[Matrix], Matrix]
    focal: float = 1.0
    scale: float = 1.0

    @property
    def is_near_factor(self) -> bool:
        """Whether it differs from the given capture by a factor near one alone."""
        factor = self.focal * self.scale
        return factor != 1.0 and 1.0 / NEAR_FACTOR <= factor <= NEAR_FACTOR


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
            mistake = mistake_of(factor)
            of_depth = f"depth may be {mistake}" if mistake else "check capture.depth_scale"
            yield Convention(
                "the poses' positions and the depth seem to be in different units: positions "
                f"{fits} fit the depth; check the tracker's unit (metres are wanted); {of_depth}",
                _scaled(factor),
                scale=factor,
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


@dataclass(frozen=True)
class Explanation:
    """What the conventions say of pairs that do not meet.

    Attributes:
        is_found: Whether pairs meet far better under some convention.
        sentence: That convention's, or "" where several of different kinds fit about as well.
    """

    is_found: bool = False
    sentence: str = ""


def explanation_of(pairs: Sequence[Pair], given: float) -> Explanation:
    """Find the convention under which pairs meet.

    Args:
        pairs: An earlier and a later frame each.
        given: Share of agreement under the poses as they came.

    Returns:
        What is found.
    """
    least = max(GOOD_SHARE, given + GAIN)
    fits = [
        (convention, shares)
        for convention in CONVENTIONS
        if _may_fit(convention, pairs, least)
        and (shares := _shares(convention, pairs))
        and _fits(convention, shares, least)
    ]
    if not fits:
        return Explanation()
    best, best_shares = max(fits, key=lambda fit: _median(fit[1]))
    if best.is_near_factor:
        others = (shares[0] for one, shares in fits if (one.focal == 1.0) != (best.focal == 1.0))
        if max(others, default=0.0) > best_shares[0] - FACTOR_MARGIN:
            return Explanation(is_found=True)
    return Explanation(True, best.sentence)


def _shares(convention: Convention, pairs: Sequence[Pair]) -> list[float]:
    """The shares of the pairs in sight of each other under a convention, rising; [] if too few."""
    found = (_under(convention, earlier, later) for earlier, later in pairs)
    shares = sorted(agreement.share for agreement in found if agreement.is_known)
    return shares if 2 * len(shares) > len(pairs) else []


def _may_fit(convention: Convention, pairs: Sequence[Pair], least: float) -> bool:
    """Whether a few samples agree nearly so well that all may."""
    found = [_under(convention, earlier, later, FEW_SAMPLES) for earlier, later in pairs]
    shares = sorted(agreement.share for agreement in found if agreement.count)
    return bool(shares) and _median(shares) > least - NOT_FAR


def _fits(convention: Convention, shares: list[float], least: float) -> bool:
    if convention.is_near_factor and (len(shares) < FACTOR_PAIRS or shares[0] < FACTOR_SHARE):
        return False
    return _median(shares) > least


def _median(rising: list[float]) -> float:
    return rising[len(rising) // 2]


def _under(
    convention: Convention, earlier: DepthSample, later: DepthSample, most: int = 4 * SAMPLES
) -> Agreement:
    try:
        relative = np.linalg.inv(convention.pose(earlier.pose)) @ convention.pose(later.pose)
    except np.linalg.LinAlgError:
        return Agreement(0.0, 1.0, 0)
    return later.meets(earlier, relative, most=most, focal=convention.focal)
