# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Prints how well depth maps of captures meet, as they are and under mistakes in their poses."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.capture.open_capture import open_capture
from reflest_core.fusion.poses.agreement import DepthSample
from reflest_core.fusion.poses.check import PoseCheck
from reflest_core.fusion.poses.conventions import OPTICAL_IN_BODY

Pose = NDArray[np.float64]
MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])
JUMP = 0.06
"""Metres that the tracker jumps by, along x and z each over the root of two."""
MISTAKES: dict[str, Callable[[Pose], Pose]] = {
    "as it is": lambda pose: pose,
    "poses of camera_link": lambda pose: pose @ np.linalg.inv(OPTICAL_IN_BODY),
    "inverse poses": lambda pose: np.linalg.inv(pose),
    "mirrored world": lambda pose: MIRROR @ pose @ MIRROR,
}


def main() -> None:
    """Print a line for each capture and mistake."""
    parser = argparse.ArgumentParser(description="Agreement of depth maps: median (least).")
    parser.add_argument("captures", nargs="+", help="bags or folders")
    for capture in parser.parse_args().captures:
        frames = list(open_capture(capture))
        for mistake, convention in MISTAKES.items():
            check = PoseCheck()
            for frame in frames:
                check.add(replace(frame, T_world_camera=convention(frame.T_world_camera)))
            report = check.report
            print(f"{capture}, {mistake}: {report.agreement:.2f} ({report.worst:.2f})")
        print(f"{capture}, tracker jumps by 6 cm: {_across_jump(frames):.2f} across the jump")


def _across_jump(frames: list[Frame]) -> float:
    """Share of depth that meets across a jump in the middle."""
    before, after = frames[len(frames) // 2 : len(frames) // 2 + 2]
    jumped = after.T_world_camera.copy()
    jumped[[0, 2], 3] += JUMP / np.sqrt(2.0)
    relative = np.linalg.inv(before.T_world_camera) @ jumped
    return DepthSample(after).meets(DepthSample(before), relative).share


if __name__ == "__main__":
    main()
