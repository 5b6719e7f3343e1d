# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Folders in which every frame has one colour image, one depth map and one pose."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.folders.files import (
    FRAME_RATE,
    ReadImage,
    colour_message,
    depth_message,
    pose_message,
    resized,
)
from reflest_core.capture.images.compressed import pixel_size
from reflest_core.capture.messages import (
    AnyImage,
    CameraInfoMessage,
    Role,
    SensorMessage,
)
from reflest_core.capture.refusal import CaptureError, FrameRefused, RefusalCause


@dataclass(frozen=True, eq=False)
class FolderFrame:
    """One frame of a folder.

    Attributes:
        stamp_ns: Stamp of its messages.
        colour: Reads the colour image.
        depth: Reads the depth map; None where there is none.
        pose: (4, 4) ``T_world_camera`` of the optical frame, NaN where unreadable; None where
            there is none.
        camera_info: The frame's own calibration; None: the folder's.
    """

    stamp_ns: int
    colour: ReadImage
    depth: ReadImage | None
    pose: NDArray[np.float64] | None
    camera_info: CameraInfoMessage | None = None


class FrameFolder:
    """Messages of a folder, frame by frame.

    Attributes:
        name: The folder as the user gave it.
        topics: What sentences call each stream.
        depth_scale: Metres in one unit of integer depth.
        depth_encoding: ``plain`` or ``rotated``, see ``capture.depth_encoding``.
        rgb_total: Number of frames.
    """

    damage: str | None = None

    def __init__(
        self,
        folder: Path,
        frames: Sequence[FolderFrame],
        camera_info: CameraInfoMessage,
        depth_scale: float,
        depth_files: str,
        pose_files: str,
        depth_info: CameraInfoMessage | None = None,
        shares_view: bool = False,
        depth_encoding: str = "plain",
    ) -> None:
        """Hold what a loader found.

        Args:
            folder: The folder.
            frames: In order of time.
            camera_info: Of the colour images.
            depth_scale: Metres in one unit of integer depth.
            depth_files: What the format calls its depth maps, for a folder that has none.
            pose_files: What holds the format's poses, for a folder that has none.
            depth_info: Of the depth maps, where they have another size than the colour images.
            shares_view: Depth maps of another size show the very view of the colour images.
            depth_encoding: How integers are stored.

        Raises:
            CaptureError: There is no frame, no depth map or no pose at all.
        """
        if not frames:
            raise CaptureError(f"{folder} holds no frame with a colour image")
        found = {
            depth_files: any(frame.depth is not None for frame in frames),
            pose_files: any(frame.pose is not None for frame in frames),
        }
        if missing := [name for name, is_there in found.items() if not is_there]:
            raise CaptureError(
                f"{folder} has no {' and no '.join(missing)}: every frame needs a depth map and a "
                "pose"
            )
        self.name = str(folder)
        self.topics = {role: f"{folder} ({role.value})" for role in Role}
        self.depth_scale: float | None = depth_scale
        self.depth_encoding: str | None = depth_encoding
        self.rgb_total: int | None = len(frames)
        self._frames = frames
        self._camera_info = camera_info
        self._depth_info = depth_info
        self._shares_view = shares_view

    def messages(
        self, refuse: Callable[[FrameRefused], None]
    ) -> Iterator[tuple[Role, SensorMessage]]:
        """Yield calibration, then pose, depth and colour of each frame, as far as they are there.

        Args:
            refuse: Called with what cannot be read.

        Yields:
            Each message with its role.
        """
        first = self._frames[0].stamp_ns
        yield Role.CAMERA_INFO, replace(self._camera_info, stamp_ns=first)
        if self._depth_info is not None:
            yield Role.DEPTH_INFO, replace(self._depth_info, stamp_ns=first)
        for frame in self._frames:
            info = frame.camera_info or self._camera_info
            if frame.camera_info is not None:
                yield Role.CAMERA_INFO, replace(info, stamp_ns=frame.stamp_ns)
            if frame.pose is not None:
                yield Role.POSE, pose_message(frame.pose, frame.stamp_ns)
            depth = self._read(frame.depth, refuse)
            if depth is not None:
                size = pixel_size(depth)
                if self._shares_view and size and size != (info.width, info.height):
                    yield Role.DEPTH_INFO, replace(resized(info, size), stamp_ns=frame.stamp_ns)
                yield Role.DEPTH, depth
            colour = self._read(frame.colour, refuse)
            if colour is not None:
                yield Role.RGB, colour

    def _read(
        self, read: ReadImage | None, refuse: Callable[[FrameRefused], None]
    ) -> AnyImage | None:
        if read is None:
            return None
        try:
            return read()
        except OSError as error:
            reason = f"{error.filename}: {error.strerror}" if error.strerror else str(error)
            refuse(FrameRefused(RefusalCause.TRUNCATED, f"an image cannot be read: {reason}"))
            return None


def usual_stamp(index: int) -> int:
    """Return the stamp of a frame whose format has no time, in nanoseconds.

    Args:
        index: The frame's number.

    Raises:
        ValueError: It is too large for a stamp.
    """
    stamp_ns = index * 10**9 // FRAME_RATE
    if stamp_ns >= 2**63:
        raise ValueError(f"frame {index} has no stamp")
    return stamp_ns


def numbered_frames(
    colours: Mapping[int, Path],
    depths: Mapping[int, Path],
    pose_of: Callable[[int], NDArray[np.float64] | None],
    stamp_of: Callable[[int], int] = usual_stamp,
) -> list[FolderFrame]:
    """Make the frames of a format whose files are numbered.

    Where numbers are too large to count frames (clock times), frames are stamped by their order.

    Args:
        colours: Colour images by their numbers.
        depths: Depth maps by their numbers.
        pose_of: Called with each frame's number for its pose, see :class:`FolderFrame`.
        stamp_of: Called with each frame's number for its stamp, nanoseconds; raises ValueError for
            a number that is too large.
    """
    try:
        stamps = [stamp_of(index) for index in colours]
    except ValueError:
        stamps = [stamp_of(place) for place in range(len(colours))]
    frames = []
    for (index, colour), stamp_ns in zip(colours.items(), stamps, strict=True):
        depth = depths.get(index)
        frames.append(
            FolderFrame(
                stamp_ns,
                partial(colour_message, colour, stamp_ns),
                None if depth is None else partial(depth_message, depth, stamp_ns),
                pose_of(index),
            )
        )
    return frames
