# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""7-Scenes folders: frame-000000.color.png (or .jpg), .depth.png, .pose.txt.

Depth is in millimetres, 65535 where unknown; poses are 4 x 4 camera-to-world matrices. The format
has no time: frame k is stamped k / 30 s, Kinect's rate.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from reflest_core.capture.formats.folder_intrinsics import Pinhole, folder_camera_info
from reflest_core.capture.messages import (
    CompressedImageMessage,
    PoseMessage,
    Role,
    SensorMessage,
)
from reflest_core.capture.pose import quaternion_of
from reflest_core.capture.refusal import CaptureError, FrameRefused

COLOUR_NAME = re.compile(r"frame-(\d+)\.color\.(png|jpe?g)$")
FRAME_RATE = 30


class SevenScenesFolder:
    """Messages of one sequence folder, frame by frame."""

    depth_scale: float | None = 0.001
    damage: str | None = None

    def __init__(self, folder: Path, pinhole: Pinhole | None) -> None:
        """Find the frames and the calibration.

        Raises:
            CaptureError: if there is no frame or no calibration.
        """
        self.name = str(folder)
        self.topics = {role: f"{folder}/*.{role.value}" for role in Role}
        self.topics[Role.RGB] = f"{folder}/*.color"
        self._folder = folder
        self._colours = sorted(
            (int(match[1]), path)
            for path in folder.iterdir()
            if (match := COLOUR_NAME.match(path.name))
        )
        if not self._colours:
            raise CaptureError(f"{folder} holds no frame-*.color.png or .jpg")
        self.rgb_total: int | None = len(self._colours)
        first_stamp = self._stamp_ns(self._colours[0][0])
        self._camera_info = folder_camera_info(folder, self._colours[0][1], first_stamp, pinhole)

    def messages(
        self, refuse: Callable[[FrameRefused], None]
    ) -> Iterator[tuple[Role, SensorMessage]]:
        """Yield calibration, then pose, depth and colour of each frame (as far as there)."""
        yield Role.CAMERA_INFO, self._camera_info
        for index, colour in self._colours:
            stamp_ns = self._stamp_ns(index)
            stem = colour.name.split(".")[0]
            pose, depth = self._folder / f"{stem}.pose.txt", self._folder / f"{stem}.depth.png"
            if pose.is_file():
                yield Role.POSE, _read_pose(pose, stamp_ns)
            if depth.is_file():
                data = depth.read_bytes()
                yield Role.DEPTH, CompressedImageMessage(stamp_ns, "", "16UC1; png", data)
            yield Role.RGB, CompressedImageMessage(stamp_ns, "", colour.suffix, colour.read_bytes())

    @staticmethod
    def _stamp_ns(index: int) -> int:
        return index * 10**9 // FRAME_RATE


def _read_pose(path: Path, stamp_ns: int) -> PoseMessage:
    """Return the pose in a file; NaN where it holds no rigid 4 x 4 matrix, to be refused."""
    try:
        matrix = np.loadtxt(path)
    except ValueError:
        matrix = np.empty(0)
    if matrix.shape != (4, 4):
        matrix = np.full((4, 4), np.nan)
    x, y, z = matrix[:3, 3].tolist()
    return PoseMessage(stamp_ns, "", (x, y, z), quaternion_of(matrix[:3, :3]))
