# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""ICL-NUIM's PNG sequences: rgb/0.png, depth/0.png and a *.gt.freiburg trajectory.

Depth counts 1/5000 m. The trajectory is that of a left-handed camera (y up, f_y = -480): camera and
world are mirrored along y here, which gives a right-handed world with the same shapes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.folders.files import (
    UNREADABLE,
    Pinhole,
    by_number,
    camera_info,
    folder_pinhole,
    image_size,
    read_text,
)
from reflest_core.capture.folders.frame_folder import FrameFolder, numbered_frames
from reflest_core.capture.pose import rigid_matrix
from reflest_core.capture.refusal import CaptureError

TRAJECTORY = ".gt.freiburg"
PINHOLE: Pinhole = (481.2, 480.0, 319.5, 239.5)
"""The data set's camera; f_y is -480 there."""
MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])


def open_icl_nuim(folder: Path, pinhole: Pinhole | None) -> FrameFolder:
    """Return the frames of one sequence.

    Args:
        folder: The folder.
        pinhole: fx, fy, cx, cy in pixels; None: camera-intrinsics.txt, else the data set's camera.

    Raises:
        CaptureError: The trajectory cannot be read or there is no frame.
    """
    colours = by_number(folder / "rgb", r"(\d+)\.(?:png|jpe?g)")
    depths = by_number(folder / "depth", r"(\d+)\.png")
    if not colours:
        raise CaptureError(f"{folder} holds no rgb/*.png")
    poses = _poses(min(folder.glob(f"*{TRAJECTORY}")))
    if pinhole is None:
        pinhole = folder_pinhole(folder, usual=PINHOLE)
    frames = numbered_frames(colours, depths, poses.get)
    fx, fy, cx, cy = pinhole
    size = image_size(next(iter(colours.values())))
    info = camera_info((fx, abs(fy), cx, cy), size)
    poses_at = f"poses of its frames in *{TRAJECTORY}"
    return FrameFolder(folder, frames, info, 1 / 5000, "depth/*.png", poses_at)


def _poses(path: Path) -> dict[int, NDArray[np.float64]]:
    found = {}
    for number, line in enumerate(read_text(path).splitlines(), start=1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        try:
            index, *values = (float(word) for word in words)
            is_whole = words[0].isdecimal()  # clock times have more digits than floats
            position, quaternion = np.array(values[:3]), np.array(values[3:])
            pose = rigid_matrix(position, quaternion / np.linalg.norm(quaternion))
            found[int(words[0]) if is_whole else int(index)] = MIRROR @ pose @ MIRROR
        except UNREADABLE as error:
            raise CaptureError(f"{path}, line {number}: expected 8 numbers") from error
    return found
