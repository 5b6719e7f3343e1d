# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Opens a capture of any kind by looking at its path."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from reflest_core.capture.assembler import RefusalListener
from reflest_core.capture.capture import Capture, MessageSource
from reflest_core.capture.folders.files import Pinhole
from reflest_core.capture.folders.kinds import KINDS, FolderKind
from reflest_core.capture.formats.bag import READERS_BY_SUFFIX, Bag
from reflest_core.capture.formats.topics import TopicChoice
from reflest_core.capture.refusal import CaptureError
from reflest_core.capture.settings import CaptureSettings

FOLDERS = ", ".join(kind.name for kind in KINDS)


def open_capture(
    path: Path | str,
    topics: TopicChoice = TopicChoice(),  # noqa: B008 (frozen, so it may be shared)
    settings: CaptureSettings = CaptureSettings(),  # noqa: B008
    pinhole: Pinhole | None = None,
    on_refusal: RefusalListener | None = None,
    on_clock_jump: Callable[[str], None] = lambda _: None,
    on_warning: Callable[[str], None] = lambda _: None,
) -> Capture:
    """Open a capture of any kind.

    Args:
        path: A bag file, a bag's directory or a folder of frames.
        topics: Topics of a bag that the user named.
        settings: Matching, units and calibration.
        pinhole: fx, fy, cx, cy in pixels, to calibrate a folder of frames.
        on_refusal: Called with each refusal and whether it is the first of its cause.
        on_clock_jump: Called between two frames where stamps start again.
        on_warning: Called with sentences on what is used though it may not be meant.

    Returns:
        The capture; iterating over it reads it.

    Raises:
        CaptureError: It does not exist, is of no known kind or cannot be read, or an argument does
            not apply to its kind.
    """
    path = Path(path)
    try:
        with np.errstate(invalid="ignore", over="ignore"):  # odd numbers in a folder's text files
            source = _open_source(path, topics, pinhole, settings.pose_source)
    except OSError as error:
        raise CaptureError(f"{path} cannot be read: {error.strerror}") from error
    return Capture(source, settings, on_refusal, on_clock_jump, on_warning)


def _open_source(
    path: Path, topics: TopicChoice, pinhole: Pinhole | None, pose_source: str
) -> MessageSource:
    if not path.exists():
        raise CaptureError(f"{path} does not exist")
    if not (path.is_dir() or path.is_file()):
        raise CaptureError(f"{path} is neither a file nor a folder, but a pipe or a device")
    names = [entry.name for entry in path.iterdir()] if path.is_dir() else [path.name]
    is_bag = any(Path(name).suffix in READERS_BY_SUFFIX for name in names)
    if is_bag or "metadata.yaml" in names:
        if pinhole is not None:
            raise CaptureError(f"{path} is a bag and has its camera_info: leave out --intrinsics")
        return Bag(path, topics, pose_source)
    folder = _folder_kind(path, names)
    if pose_source == "tf":
        raise CaptureError(f"{path} is a folder of frames and has no tf: leave out --world-frame")
    if topics != TopicChoice():
        raise CaptureError(f"{path} is a folder of frames and has no topics to choose")
    return folder.open(path, pinhole)


def _folder_kind(path: Path, names: list[str]) -> FolderKind:
    if path.is_dir():
        for kind in KINDS:
            if kind.is_it(set(names)):
                return kind
    if path.suffix == ".bag":
        raise CaptureError(f"{path} is a ROS 1 bag: convert it with rosbags-convert")
    if path.suffix == ".r3d" or "rgbd" in names:
        raise CaptureError(
            f"{path} is a Record3D recording (.r3d), whose depth is compressed with LZFSE, which "
            "is not read: export it from the app as EXR + RGB"
        )
    raise CaptureError(
        f"{path} is not a capture: expected an .mcap or .db3 file, a rosbag2 directory, or a "
        f"folder of one of these formats: {FOLDERS}"
    )
