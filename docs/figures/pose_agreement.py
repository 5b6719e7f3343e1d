# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Prints how well depth maps and colours of captures meet, as they are and under mistakes."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.capture.frame import Frame
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.pose import rigid_matrix
from reflest_core.fusion.poses.agreement import DepthSample
from reflest_core.fusion.poses.check import PoseCheck
from reflest_core.fusion.poses.conventions import OPTICAL_IN_BODY

Pose = NDArray[np.float64]
Rgb = NDArray[np.uint8]
Fault = Callable[[list[Frame]], list[Frame]]
MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])
JUMP = 0.06
"""Metres that the tracker jumps by, along x and z each over the root of two."""
MOUNTING = rigid_matrix(np.array([0.05, 0.02, 0.0]), np.array([0.0, 0.0, 0.0, 1.0]))
POSITIONS = np.ones((4, 4))
POSITIONS[:3, 3] = 0.8
MISTAKES: dict[str, Callable[[Pose], Pose]] = {
    "as it is": lambda pose: pose,
    "poses of camera_link": lambda pose: pose @ np.linalg.inv(OPTICAL_IN_BODY),
    "inverse poses": lambda pose: np.linalg.inv(pose),
    "mirrored world": lambda pose: MIRROR @ pose @ MIRROR,
    "camera 5 cm from its pose": lambda pose: pose @ np.linalg.inv(MOUNTING),
    "positions x 0.8": lambda pose: pose * POSITIONS,
}


def _seen_by(focal: float = 1.0, right: float = 0.0) -> Fault:
    """Focal lengths times a factor, and a centre moved by pixels."""

    def fault(frames: list[Frame]) -> list[Frame]:
        found = []
        for frame in frames:
            camera = frame.intrinsics
            camera = replace(
                camera, fx=focal * camera.fx, fy=focal * camera.fy, cx=camera.cx + right
            )
            found.append(replace(frame, intrinsics=camera))
        return found

    return fault


def _late(by: int) -> Fault:
    """Colours of so many frames before."""
    return lambda frames: [
        replace(frame, rgb=other.rgb)
        for frame, other in zip(frames[by:], frames[:-by], strict=True)
    ]


def _reversed(frames: list[Frame]) -> list[Frame]:
    pairs = zip(frames, reversed(frames), strict=True)
    return [replace(frame, rgb=other.rgb) for frame, other in pairs]


def _changed(change: Callable[[Rgb], Rgb]) -> Fault:
    return lambda frames: [
        replace(frame, rgb=np.ascontiguousarray(change(frame.rgb))) for frame in frames
    ]


def _wider(rgb: Rgb) -> Rgb:
    """The middle three quarters, enlarged."""
    height, width = rgb.shape[:2]
    rows = np.round(0.75 * (np.arange(height) - height / 2) + height / 2).astype(int)
    columns = np.round(0.75 * (np.arange(width) - width / 2) + width / 2).astype(int)
    return rgb[np.ix_(rows, columns)]


def _shuffled(frames: list[Frame]) -> list[Frame]:
    order = np.random.default_rng(0).permutation(len(frames))
    return [replace(frame, rgb=frames[k].rgb) for frame, k in zip(frames, order, strict=True)]


def _linear(frames: list[Frame]) -> list[Frame]:
    return [
        replace(frame, rgb=np.round(255.0 * srgb.LINEAR[frame.rgb]).astype(np.uint8))
        for frame in frames
    ]


FAULTS: dict[str, Fault] = {
    **{f"focal lengths x {focal}": _seen_by(focal) for focal in (0.75, 0.85, 1.15, 1.5, 2.0)},
    "centre 10 pixels to the right": _seen_by(right=10.0),
    **{f"colours {by} frames late": _late(by) for by in (1, 2, 3, 5)},
    "colours reversed": _reversed,
    "colours upside down": _changed(lambda rgb: rgb[::-1]),
    "colours mirrored": _changed(lambda rgb: rgb[:, ::-1]),
    "colours turned by 180 degrees": _changed(lambda rgb: rgb[::-1, ::-1]),
    "colours 10 pixels to the right": _changed(lambda rgb: np.roll(rgb, 10, axis=1)),
    "colours enlarged by a third": _changed(_wider),
    "colours of other frames": _shuffled,
    "linear colours": _linear,
}
JUMPS: dict[str, Pose] = {
    "10 cm": rigid_matrix(np.array([0.1, 0.0, 0.0]), np.array([0.0, 0.0, 0.0, 1.0])),
    "5 degrees": rigid_matrix(
        np.zeros(3), np.array([0.0, 0.0, np.sin(np.radians(2.5)), np.cos(np.radians(2.5))])
    ),
}
FIRST, LAST = 6, 3
"""A jump is tried before every frame but so many at the beginning and at the end."""
THICKNESS = 0.006
"""Half that of a bare table, whose plane is z = 0; metres."""


def main() -> None:
    """Print a line for each capture and mistake."""
    parser = argparse.ArgumentParser(
        description="Agreement of depth maps: median (least), and of colours."
    )
    parser.add_argument(
        "--bare-table", action="store_true", help="keep the depth of the plane z = 0 alone"
    )
    parser.add_argument("captures", nargs="+", help="bags or folders")
    options = parser.parse_args()
    for capture in options.captures:
        frames = list(open_capture(capture))
        if options.bare_table:
            frames = [_plane(frame) for frame in frames]
        for mistake, convention in MISTAKES.items():
            moved = [
                replace(frame, T_world_camera=convention(frame.T_world_camera)) for frame in frames
            ]
            _print(f"{capture}, {mistake}", moved)
        for mistake, fault in FAULTS.items():
            _print(f"{capture}, {mistake}", fault(frames))
        print(f"{capture}, tracker jumps by 6 cm: {_across_jump(frames):.2f} across the jump")
        for name, jump in JUMPS.items():
            places = range(FIRST, len(frames) - LAST + 1)
            found = sum(_is_found(frames, jump, place) for place in places)
            print(f"{capture}, tracker jumps by {name}: found at {found} of {len(places)} places")


def _print(what: str, frames: list[Frame]) -> None:
    check = PoseCheck()
    for frame in frames:
        check.add(frame)
    report = check.report
    print(
        f"{what}: {report.agreement:.2f} ({report.worst:.2f}), colours "
        f"{report.colour_agreement:.2f}: "
        f"{report.problem or report.warning or 'no problem'}"
    )


def _plane(frame: Frame) -> Frame:
    """Only the depth of the plane z = 0."""
    rows, columns = np.mgrid[: frame.depth.shape[0], : frame.depth.shape[1]]
    camera, depth = frame.intrinsics, frame.depth
    points = [(columns - camera.cx) / camera.fx, (rows - camera.cy) / camera.fy, 1.0]
    up = frame.T_world_camera[2]
    height = depth * sum(up[axis] * points[axis] for axis in range(3)) + up[3]
    return replace(frame, depth=np.where(np.abs(height) < THICKNESS, depth, 0.0).astype(np.float32))


def _is_found(frames: list[Frame], jump: Pose, place: int) -> bool:
    """Whether a jump before a frame is confirmed by the frame after it."""
    check = PoseCheck()
    for index, frame in enumerate(frames[: place + 2]):
        pose = jump @ frame.T_world_camera if index >= place else frame.T_world_camera
        if check.add(replace(frame, T_world_camera=pose)) is not None:
            return index == place + 1
    return False


def _across_jump(frames: list[Frame]) -> float:
    """Share of depth that meets across a jump in the middle."""
    before, after = frames[len(frames) // 2 : len(frames) // 2 + 2]
    jumped = after.T_world_camera.copy()
    jumped[[0, 2], 3] += JUMP / np.sqrt(2.0)
    relative = np.linalg.inv(before.T_world_camera) @ jumped
    return DepthSample(after).meets(DepthSample(before), relative).share


if __name__ == "__main__":
    main()
