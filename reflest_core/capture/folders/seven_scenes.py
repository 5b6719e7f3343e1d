# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""7-Scenes and 3RScan folders: frame-000000.color.png (or .jpg), .depth.png (or .pgm), .pose.txt.

Depth is in millimetres, 65535 where unknown; poses are 4 x 4 camera-to-world matrices. The format
has no time: frame k is stamped k / 30 s, Kinect's rate. 3RScan's depth maps are smaller than its
colour images; ``_info.txt`` has both calibrations. Captures of robot arms whose integers are stored
with rotated bits (from the Amazon Picking Challenge) are known by their calibration's name,
``camera-intrinsics.color.txt``.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from reflest_core.capture.folders.files import (
    INTRINSICS,
    Pinhole,
    by_number,
    camera_info,
    folder_pinhole,
    image_size,
    pinhole_of,
    pose_in,
    read_text,
)
from reflest_core.capture.folders.frame_folder import FrameFolder, numbered_frames
from reflest_core.capture.messages import CameraInfoMessage
from reflest_core.capture.refusal import CaptureError
from reflest_core.capture.settings import ROTATED_SCALE

COLOUR_NAME = re.compile(r"frame-(\d+)\.color\.(png|jpe?g)", re.IGNORECASE)
DEPTH_NAME = r"frame-(\d+)\.depth\.(?:png|pgm|tiff?)"
INFO_LINE = re.compile(r"m_calibration(Color|Depth)Intrinsic\s*=\s*([^\n]*)")
ROTATED_BY = INTRINSICS[1]
"""The calibration's name in captures whose depth has rotated bits."""


def open_seven_scenes(folder: Path, pinhole: Pinhole | None) -> FrameFolder:
    """Return the frames of one sequence folder.

    Args:
        folder: The folder.
        pinhole: fx, fy, cx, cy of the colour images in pixels; None reads the folder's.

    Raises:
        CaptureError: There is no frame or no calibration.
    """
    colours = by_number(folder, COLOUR_NAME.pattern)
    depths = by_number(folder, DEPTH_NAME)
    if not colours:
        raise CaptureError(f"{folder} holds no frame-*.color.png or .jpg")
    poses = {
        index: folder / f"{colour.name.split('.')[0]}.pose.txt" for index, colour in colours.items()
    }
    frames = numbered_frames(colours, depths, lambda index: pose_in(poses[index]))
    size = image_size(next(iter(colours.values())))
    given = _calibrations(folder)
    if pinhole is None:
        pinhole = given.get("Color") or folder_pinhole(folder)
    depth_info: CameraInfoMessage | None = None
    if "Depth" in given and depths:
        depth_info = camera_info(given["Depth"], image_size(next(iter(depths.values()))))
    is_rotated = (folder / ROTATED_BY).is_file()
    return FrameFolder(
        folder,
        frames,
        camera_info(pinhole, size),
        ROTATED_SCALE if is_rotated else 0.001,
        "frame-*.depth.png (or .pgm)",
        "frame-*.pose.txt",
        depth_info,
        depth_encoding="rotated" if is_rotated else "plain",
    )


def _calibrations(folder: Path) -> dict[str, Pinhole]:
    """Return 3RScan's calibrations of colour and depth, where the folder has its _info.txt."""
    path = folder / "_info.txt"
    if not path.is_file():
        return {}
    found = {}
    for match in INFO_LINE.finditer(read_text(path)):
        try:
            matrix = np.array([float(word) for word in match[2].split()]).reshape(4, 4)
        except ValueError as error:
            raise CaptureError(f"{path}: {match[0]!r} is no 4 x 4 matrix") from error
        found[match[1]] = pinhole_of(matrix)
    return found
