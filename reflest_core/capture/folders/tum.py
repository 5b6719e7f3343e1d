# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""TUM RGB-D and OpenLORIS folders: lists of colour, depth and poses, each line led by its stamp.

TUM's depth counts 1/5000 m, OpenLORIS' aligned depth 1 mm. Poses are of the colour camera's optical
frame, tx ty tz qx qy qz qw; OpenLORIS gives those of the robot's base, which
``capture.pose_to_camera`` takes to the camera.
"""

from __future__ import annotations

import heapq
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from decimal import Decimal, InvalidOperation
from pathlib import Path

from reflest_core.capture.folders.files import (
    Pinhole,
    camera_info,
    colour_message,
    depth_message,
    folder_pinhole,
    image_size,
    read_text,
)
from reflest_core.capture.messages import PoseMessage, Role, SensorMessage
from reflest_core.capture.refusal import CaptureError, FrameRefused, RefusalCause

TUM_LISTS = {Role.RGB: "rgb.txt", Role.DEPTH: "depth.txt", Role.POSE: "groundtruth.txt"}
OPENLORIS_LISTS = {**TUM_LISTS, Role.RGB: "color.txt", Role.DEPTH: "aligned_depth.txt"}
SENSORS = "sensors.yaml"
COLOUR_CAMERA = "d400_color_optical_frame"
LAST_SECOND = Decimal(2**63) / 10**9
Line = tuple[int, list[str]]


def open_tum(folder: Path, pinhole: Pinhole | None) -> TumFolder:
    """Return a TUM sequence.

    Args:
        folder: The folder with rgb.txt, depth.txt and groundtruth.txt.
        pinhole: fx, fy, cx, cy in pixels; None reads camera-intrinsics.txt.

    Raises:
        CaptureError: A list or the calibration is missing or cannot be read.
    """
    return TumFolder(folder, pinhole, TUM_LISTS, 1 / 5000)


def open_openloris(folder: Path, pinhole: Pinhole | None) -> TumFolder:
    """Return an OpenLORIS sequence; arguments and errors are those of :func:`open_tum`.

    Args:
        folder: The folder with color.txt, aligned_depth.txt and groundtruth.txt.
        pinhole: fx, fy, cx, cy in pixels; None reads sensors.yaml of the folder or its parent, or
            camera-intrinsics.txt.
    """
    if pinhole is None:
        for place in (folder, folder.absolute().parent):
            if (place / SENSORS).is_file():
                pinhole = _colour_camera(place / SENSORS)
                break
    return TumFolder(folder, pinhole, OPENLORIS_LISTS, 0.001)


def _colour_camera(path: Path) -> Pinhole:
    """The colour camera's fx, fy, cx, cy of OpenLORIS' sensors.yaml, which has fx, cx, fy, cy."""
    # OpenCV wrote the file, whose first line YAML readers refuse.
    _, _, of_camera = f"\n{read_text(path)}".partition(f"\n{COLOUR_CAMERA}:")
    _, _, intrinsics = re.split(r"\n(?=\S)", of_camera, maxsplit=1)[0].partition("intrinsics:")
    numbers = intrinsics.partition("[")[2].partition("]")[0].split(",")
    try:
        fx, cx, fy, cy = (float(word) for word in numbers)
    except ValueError:
        fx = fy = cx = cy = 0.0
    if not 0.5 < fx / max(fy, 1e-9) < 2.0:
        raise CaptureError(
            f"{path} holds no intrinsics fx, cx, fy, cy of {COLOUR_CAMERA}: give "
            "--intrinsics FX FY CX CY"
        )
    return fx, fy, cx, cy


class TumFolder:
    """Messages of one sequence folder, in stamp order.

    Attributes:
        name: The folder as the user gave it.
        topics: What sentences call each stream.
        depth_scale: Metres in one unit of depth.
        rgb_total: Number of colour images.
    """

    damage: str | None = None
    depth_encoding: str | None = "plain"

    def __init__(
        self, folder: Path, pinhole: Pinhole | None, lists: dict[Role, str], depth_scale: float
    ) -> None:
        """Read the three lists and find the calibration.

        Args:
            folder: The folder.
            pinhole: fx, fy, cx, cy in pixels; None reads camera-intrinsics.txt.
            lists: Name of each stream's list.
            depth_scale: Metres in one unit of depth.

        Raises:
            CaptureError: A list or the calibration is missing or cannot be read.
        """
        self.name = str(folder)
        self.topics = {role: str(folder / name) for role, name in lists.items()}
        self.topics[Role.CAMERA_INFO] = f"{folder} (calibration)"
        self.depth_scale: float | None = depth_scale
        self._folder = folder
        if missing := [name for name in lists.values() if not (folder / name).exists()]:
            raise CaptureError(
                f"{folder} has no {' and no '.join(missing)}: the format needs "
                f"{', '.join(lists.values())}"
            )
        self._lines = {
            role: _read_list(folder / name, 8 if role is Role.POSE else 2)
            for role, name in lists.items()
        }
        self.rgb_total: int | None = len(self._lines[Role.RGB])
        first_stamp, first_words = self._lines[Role.RGB][0]
        first_image = folder / first_words[0]
        if not first_image.is_file():
            raise CaptureError(f"{first_image}, listed in {lists[Role.RGB]}, does not exist")
        size = image_size(first_image)
        info = camera_info(folder_pinhole(folder) if pinhole is None else pinhole, size)
        self._camera_info = replace(info, stamp_ns=first_stamp)

    def messages(
        self, refuse: Callable[[FrameRefused], None]
    ) -> Iterator[tuple[Role, SensorMessage]]:
        """Yield calibration, then all messages by stamp.

        Args:
            refuse: Called with images that cannot be read.

        Yields:
            Each message with its role.
        """
        yield Role.CAMERA_INFO, self._camera_info
        streams = (
            [(stamp_ns, place, role, words) for stamp_ns, words in self._lines[role]]
            for place, role in enumerate((Role.POSE, Role.DEPTH, Role.RGB))
        )
        for stamp_ns, _, role, words in heapq.merge(*streams, key=lambda item: item[:2]):
            if role is Role.POSE:
                yield role, _pose(stamp_ns, words)
                continue
            path = self._folder / words[0]
            try:
                read = colour_message if role is Role.RGB else depth_message
                yield role, read(path, stamp_ns)
            except OSError as error:
                sentence = f"{path} cannot be read: {error.strerror}"
                refuse(FrameRefused(RefusalCause.TRUNCATED, sentence))


def _pose(stamp_ns: int, words: list[str]) -> PoseMessage:
    try:
        x, y, z, qx, qy, qz, qw = (float(word) for word in words)
    except ValueError:
        x = y = z = qx = qy = qz = qw = float("nan")
    return PoseMessage(stamp_ns, "", (x, y, z), (qx, qy, qz, qw))


def _read_list(path: Path, columns: int) -> list[Line]:
    """Return (stamp, the other words) of each line that is no comment, sorted by stamp."""
    lines = []
    for number, line in enumerate(read_text(path).splitlines(), start=1):
        words = line.replace(",", " ").split()
        if not words or words[0].startswith("#"):
            continue
        try:
            seconds = Decimal(words[0])
            is_time = 0 <= seconds < LAST_SECOND
        except InvalidOperation:
            is_time = False
        if not is_time or len(words) != columns:
            raise CaptureError(f"{path}, line {number}: expected a stamp and {columns - 1} values")
        lines.append((int(seconds * 10**9), words[1:]))
    if not lines:
        raise CaptureError(f"{path} is empty")
    return sorted(lines, key=lambda line: line[0])
