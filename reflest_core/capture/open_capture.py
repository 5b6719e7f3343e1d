# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Opens a capture of any kind by looking at its path."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from reflest_core.capture.assembler import RefusalListener
from reflest_core.capture.capture import Capture, MessageSource
from reflest_core.capture.formats.bag import READERS_BY_SUFFIX, Bag
from reflest_core.capture.formats.folder_intrinsics import Pinhole
from reflest_core.capture.formats.seven_scenes import COLOUR_NAME, SevenScenesFolder
from reflest_core.capture.formats.topics import TopicChoice
from reflest_core.capture.formats.tum import LISTS, TumFolder
from reflest_core.capture.refusal import CaptureError
from reflest_core.capture.settings import CaptureSettings

KINDS = (
    "an .mcap or .db3 file, a rosbag2 directory, a 7-Scenes folder (frame-*.color.*) or a TUM "
    "folder (rgb.txt, depth.txt, groundtruth.txt)"
)


def open_capture(
    path: Path | str,
    topics: TopicChoice = TopicChoice(),  # noqa: B008 (frozen, so it may be shared)
    settings: CaptureSettings = CaptureSettings(),  # noqa: B008
    pinhole: Pinhole | None = None,
    on_refusal: RefusalListener | None = None,
    on_clock_jump: Callable[[str], None] = lambda _: None,
    on_warning: Callable[[str], None] = lambda _: None,
) -> Capture:
    """Return the capture at ``path``.

    ``topics`` names topics of a bag; ``pinhole`` (fx, fy, cx, cy in pixels) calibrates a folder.
    ``on_clock_jump`` is called between two frames where stamps start again.

    Raises:
        CaptureError: if it does not exist, is of no known kind or cannot be read, or if an
            argument does not apply to its kind.
    """
    path = Path(path)
    try:
        source = _open_source(path, topics, pinhole, settings.pose_source)
    except OSError as error:
        raise CaptureError(f"{path} cannot be read: {error.strerror}") from error
    return Capture(source, settings, on_refusal, on_clock_jump, on_warning)


def _open_source(
    path: Path, topics: TopicChoice, pinhole: Pinhole | None, pose_source: str
) -> MessageSource:
    if not path.exists():
        raise CaptureError(f"{path} does not exist")
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
    return folder(path, pinhole)


def _folder_kind(path: Path, names: list[str]) -> type[SevenScenesFolder] | type[TumFolder]:
    if path.is_dir() and set(LISTS.values()) & set(names):
        return TumFolder
    if path.is_dir() and any(COLOUR_NAME.match(name) for name in names):
        return SevenScenesFolder
    if path.suffix == ".bag":
        raise CaptureError(f"{path} is a ROS 1 bag: convert it with rosbags-convert")
    raise CaptureError(f"{path} is not a capture: expected {KINDS}")
