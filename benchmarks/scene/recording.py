# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The scene as a bag, rendered once into a cache folder outside the repository."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tqdm import tqdm

from benchmarks.scene.hand_held_orbit import pose_at
from benchmarks.scene.renderer import camera_of, render
from benchmarks.scene.table_scene import VERSION
from reflest_core.capture.frame import Frame
from reflest_core.synbrdf.sequences.bag_writer import (
    CAMERA_FRAME,
    WORLD_FRAME,
    RecordedFrame,
    write_bag,
)
from reflest_core.whole_file import whole_folder

START_NS = 1_750_000_000 * 10**9


@dataclass(frozen=True)
class Recording:
    """What is rendered.

    Attributes:
        width: Pixels.
        height: Pixels.
        frames: Number of images.
        rate: Hz.
    """

    width: int
    height: int
    frames: int
    rate: float

    @property
    def seconds(self) -> float:
        """Duration from the first image to one period after the last."""
        return self.frames / self.rate


def recorded(recording: Recording, cache: Path) -> Path:
    """The bag of a recording, rendered if the cache does not hold it.

    Args:
        recording: What to render.
        cache: The cache folder.

    Returns:
        The rosbag2 folder.
    """
    name = (
        f"table-{VERSION}-{recording.width}x{recording.height}-"
        f"{recording.frames}-at-{recording.rate:g}hz"
    )
    bag = cache / name
    if bag.exists():
        return bag
    camera = camera_of(recording.width, recording.height)
    frames = tqdm(_frames(recording), "rendering", recording.frames, unit="frame", disable=None)
    with whole_folder(bag) as unfinished:
        write_bag(unfinished, camera, frames, is_compressed=False)
    return bag


def _frames(recording: Recording) -> Iterator[RecordedFrame]:
    camera = camera_of(recording.width, recording.height)
    for number in range(recording.frames):
        pose = pose_at(number / recording.rate)
        rgb, depth_mm = render(camera, pose, number)
        stamp_ns = START_NS + round(number * 1e9 / recording.rate)
        yield RecordedFrame(stamp_ns, rgb, depth_mm, pose)


def rendered_frames(recording: Recording) -> Iterator[Frame]:
    """The same frames without a bag, as fusion takes them; rendered one by one.

    Args:
        recording: What to render.
    """
    camera = camera_of(recording.width, recording.height)
    for one in _frames(recording):
        yield Frame(
            stamp_ns=one.stamp_ns,
            rgb=one.rgb,
            depth=(one.depth_mm * 0.001).astype(np.float32),
            T_world_camera=one.pose,
            intrinsics=camera,
            frame_id=CAMERA_FRAME,
            world_frame_id=WORLD_FRAME,
        )
