# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Stray Scanner folders: rgb.mp4, depth/000000.png, odometry.csv, camera_matrix.csv.

Depth is in millimetres and smaller than the video, of the same view. Poses are camera-to-world of
optical frames, in a world whose y points up (``--up 0 1 0``).
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import cv2
import numpy as np

from reflest_core.capture.folders.files import (
    UNREADABLE,
    Pinhole,
    by_number,
    camera_info,
    depth_message,
    image_message,
    pinhole_of,
    read_matrix,
    read_text,
    stamp_of,
)
from reflest_core.capture.folders.frame_folder import FolderFrame, FrameFolder
from reflest_core.capture.messages import AnyImage
from reflest_core.capture.pose import rigid_matrix
from reflest_core.capture.refusal import CaptureError

VIDEO, ODOMETRY, MATRIX = "rgb.mp4", "odometry.csv", "camera_matrix.csv"


class _Video:
    """Frames of a video, read one after the other."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._capture = cv2.VideoCapture(str(path))
        self._next = 0
        width = int(self._capture.get(cv2.CAP_PROP_FRAME_WIDTH))
        height = int(self._capture.get(cv2.CAP_PROP_FRAME_HEIGHT))
        if not self._capture.isOpened() or width < 1 or height < 1:
            raise CaptureError(f"{path} is missing or cannot be read as a video")
        self.size = width, height

    def frame(self, index: int, stamp_ns: int) -> AnyImage:
        """Return a frame; those before it are passed over."""
        while self._next < index and self._capture.grab():
            self._next += 1
        is_read, pixels = self._capture.read()
        if not is_read:
            raise OSError(f"{self._path} ends before frame {index}")
        self._next += 1
        return image_message(np.asarray(pixels, np.uint8), "bgr8", stamp_ns)


def open_stray_scanner(folder: Path, pinhole: Pinhole | None) -> FrameFolder:
    """Return the frames of one recording.

    Args:
        folder: The folder.
        pinhole: fx, fy, cx, cy of the video in pixels; None reads camera_matrix.csv.

    Raises:
        CaptureError: The video, the odometry or the calibration cannot be read.
    """
    video = _Video(folder / VIDEO)
    if pinhole is None:
        matrix = read_matrix(folder / MATRIX, (3, 3))
        if matrix is None:
            raise CaptureError(f"{folder / MATRIX} does not hold a 3 x 3 camera matrix")
        pinhole = pinhole_of(matrix)
    depths = by_number(folder / "depth", r"(\d+)\.(?:png|npy)")
    frames = []
    for index, (stamp_ns, place, quaternion) in enumerate(_rows(folder / ODOMETRY)):
        depth = depths.get(index)
        norm = float(np.linalg.norm(quaternion))
        pose = rigid_matrix(place, quaternion / norm) if norm > 0.0 else np.full((4, 4), np.nan)
        frames.append(
            FolderFrame(
                stamp_ns,
                partial(video.frame, index, stamp_ns),
                None if depth is None else partial(depth_message, depth, stamp_ns),
                pose,
            )
        )
    return FrameFolder(
        folder,
        frames,
        camera_info(pinhole, video.size),
        0.001,
        "depth/*.png",
        f"poses in {ODOMETRY}",
        shares_view=True,
    )


def _rows(path: Path) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Yield stamp, position and quaternion xyzw of each line."""
    reader = csv.DictReader(read_text(path).splitlines(), skipinitialspace=True)
    try:
        for row in reader:
            values = {name.strip(): float(value) for name, value in row.items() if name and value}
            place = np.array([values[name] for name in ("x", "y", "z")])
            quaternion = np.array([values[name] for name in ("qx", "qy", "qz", "qw")])
            yield stamp_of(values["timestamp"]), place, quaternion
    except (*UNREADABLE, csv.Error) as error:
        raise CaptureError(
            f"{path}, line {reader.line_num}: expected timestamp, frame, x, y, z, qx, qy, qz, qw"
        ) from error
