# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""TUM RGB-D folders: rgb.txt, depth.txt and groundtruth.txt, each line led by its stamp.

Depth counts 1/5000 m. Poses are of the colour camera's optical frame: tx ty tz qx qy qz qw.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterator
from decimal import Decimal, InvalidOperation
from pathlib import Path

from reflest_core.capture.formats.folder_intrinsics import Pinhole, folder_camera_info
from reflest_core.capture.messages import (
    CompressedImageMessage,
    PoseMessage,
    Role,
    SensorMessage,
)
from reflest_core.capture.refusal import CaptureError, FrameRefused, RefusalCause

LISTS = {Role.RGB: "rgb.txt", Role.DEPTH: "depth.txt", Role.POSE: "groundtruth.txt"}
Line = tuple[int, list[str]]


class TumFolder:
    """Messages of one sequence folder, in stamp order."""

    depth_scale: float | None = 1 / 5000
    damage: str | None = None

    def __init__(self, folder: Path, pinhole: Pinhole | None) -> None:
        """Read the three lists and find the calibration.

        Raises:
            CaptureError: if a list or the calibration is missing or cannot be read.
        """
        self.name = str(folder)
        self.topics = {role: str(folder / name) for role, name in LISTS.items()}
        self.topics[Role.CAMERA_INFO] = f"{folder} (calibration)"
        self._folder = folder
        self._lines = {
            role: _read_list(folder / name, 8 if role is Role.POSE else 2)
            for role, name in LISTS.items()
        }
        self.rgb_total: int | None = len(self._lines[Role.RGB])
        first_stamp, first_words = self._lines[Role.RGB][0]
        first_image = folder / first_words[0]
        if not first_image.is_file():
            raise CaptureError(f"{first_image}, listed in rgb.txt, does not exist")
        self._camera_info = folder_camera_info(folder, first_image, first_stamp, pinhole)

    def messages(
        self, refuse: Callable[[FrameRefused], None]
    ) -> Iterator[tuple[Role, SensorMessage]]:
        """Yield calibration, then all messages by stamp; missing images go to ``refuse``."""
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
                yield role, CompressedImageMessage(stamp_ns, "", path.suffix, path.read_bytes())
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
    try:
        text = path.read_text()
    except (OSError, UnicodeDecodeError) as error:
        raise CaptureError(f"{path} cannot be read: {error}") from error
    lines = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        try:
            stamp_ns = int(Decimal(words[0]) * 10**9)
        except (InvalidOperation, ValueError, OverflowError):
            stamp_ns = -1
        if stamp_ns < 0 or len(words) != columns:
            raise CaptureError(f"{path}, line {number}: expected a stamp and {columns - 1} values")
        lines.append((stamp_ns, words[1:]))
    if not lines:
        raise CaptureError(f"{path} is empty")
    return sorted(lines, key=lambda line: line[0])
