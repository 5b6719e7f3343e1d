# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Captures of the Amazon Picking Challenge: cam.info.txt beside frame-*.color.png and .depth.png.

``cam.info.txt`` holds the calibrations and every frame's camera-to-world matrix. Depth was
projected into the colour camera without filling, in units of 0.1 mm with rotated bits.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.folders.files import (
    Pinhole,
    by_number,
    camera_info,
    image_size,
    pinhole_of,
    read_text,
)
from reflest_core.capture.folders.frame_folder import FrameFolder, numbered_frames
from reflest_core.capture.folders.seven_scenes import COLOUR_NAME, DEPTH_NAME
from reflest_core.capture.refusal import CaptureError
from reflest_core.capture.settings import ROTATED_SCALE

INFO = "cam.info.txt"
COLOUR_TITLE = "Color camera intrinsic matrix"
POSE_TITLE = re.compile(r"Camera-to-world .* for frame-(\d{1,255})\b")


def open_apc(folder: Path, pinhole: Pinhole | None) -> FrameFolder:
    """Return the frames of one such folder.

    Args:
        folder: The folder.
        pinhole: fx, fy, cx, cy of the colour images in pixels; None reads cam.info.txt.

    Raises:
        CaptureError: cam.info.txt cannot be read, or there is no frame.
    """
    matrices = _matrices(folder / INFO)
    titles = {title: match for title in matrices if (match := POSE_TITLE.match(title))}
    poses = {int(match[1]): matrices[title] for title, match in titles.items()}
    if wrong := [title for title in titles if matrices[title].shape != (4, 4)]:
        raise CaptureError(f"{folder / INFO}: {wrong[0]!r} is no 4 x 4 matrix")
    colours, depths = by_number(folder, COLOUR_NAME.pattern), by_number(folder, DEPTH_NAME)
    if pinhole is None:
        if COLOUR_TITLE not in matrices:
            raise CaptureError(f"{folder / INFO} has no {COLOUR_TITLE!r}: give --intrinsics")
        pinhole = pinhole_of(matrices[COLOUR_TITLE])
    frames = numbered_frames(colours, depths, poses.get)
    size = image_size(next(iter(colours.values()))) if colours else (0, 0)
    return FrameFolder(
        folder,
        frames,
        camera_info(pinhole, size),
        ROTATED_SCALE,
        "frame-*.depth.png",
        f"poses of its frames in {INFO}",
        depth_encoding="rotated",
    )


def _matrices(path: Path) -> dict[str, NDArray[np.float64]]:
    """Return the square matrices of a file by the comments above them."""
    found: dict[str, NDArray[np.float64]] = {}
    title = ""
    rows: list[list[float]] = []
    for line in [*read_text(path).splitlines(), ""]:
        if line.startswith("#"):
            title, rows = line.lstrip("# ").strip(), []
        elif line.strip():
            try:
                rows.append([float(word) for word in line.split()])
            except ValueError as error:
                raise CaptureError(f"{path}: {line!r} is no row of a matrix") from error
        elif rows:
            if len(rows) not in (3, 4) or any(len(row) != len(rows) for row in rows):
                raise CaptureError(f"{path}: {title!r} is no square matrix")
            found[title], rows = np.array(rows), []
    return found
