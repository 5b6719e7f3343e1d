# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Record3D's export of EXR and RGB: metadata.json, rgb/0.jpg, depth/0.exr (or .npy, .png).

The metadata hold the camera matrix column by column and poses as quaternion and position, of
OpenGL cameras in a world whose y points up (``--up 0 1 0``). Depth is in metres, smaller than
colour, of the same view.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.capture.folders.files import (
    FRAME_RATE,
    MOST_SECONDS,
    UNREADABLE,
    Pinhole,
    by_number,
    camera_info,
    image_size,
    pinhole_of,
    read_text,
    stamp_of,
)
from reflest_core.capture.folders.frame_folder import FrameFolder, numbered_frames
from reflest_core.capture.folders.nerfstudio import FROM_OPENGL
from reflest_core.capture.pose import rigid_matrix
from reflest_core.capture.refusal import CaptureError

METADATA, IMAGES = "metadata.json", "EXR_RGBD"


def open_record3d(folder: Path, pinhole: Pinhole | None) -> FrameFolder:
    """Return the frames of one recording.

    Args:
        folder: The folder with metadata.json; images lie in it or in its EXR_RGBD.
        pinhole: fx, fy, cx, cy of the colour images in pixels; None reads the metadata.

    Raises:
        CaptureError: The metadata are damaged or there is no frame.
    """
    path = folder / METADATA
    try:
        metadata: dict[str, Any] = json.loads(read_text(path))
        rate = float(metadata.get("fps") or FRAME_RATE)
        poses = [_pose(values) for values in metadata["poses"]]
        if pinhole is None:
            pinhole = pinhole_of(np.array(metadata["K"], np.float64).reshape(3, 3).T)
    except UNREADABLE as error:
        raise CaptureError(f"{path} holds no K of 9 numbers and poses of 7: {error}") from error
    place = folder / IMAGES if (folder / IMAGES).is_dir() else folder
    colours = by_number(place / "rgb", r"(\d+)\.(?:jpe?g|png)")
    depths = by_number(place / "depth", r"(\d+)\.(?:exr|npy|png|tiff?)")
    if not colours:
        raise CaptureError(f"{place} holds no rgb/*.jpg: export a recording as EXR + RGB")
    if not len(colours) / rate < MOST_SECONDS:
        raise CaptureError(f"{path} gives {rate:g} frames a second: correct its fps")
    frames = numbered_frames(
        colours,
        depths,
        lambda index: poses[index] if index < len(poses) else None,
        lambda index: stamp_of(index / rate),
    )
    size = image_size(next(iter(colours.values())))
    return FrameFolder(
        folder,
        frames,
        camera_info(pinhole, size),
        0.001,
        "depth/*.exr (or .npy, .png)",
        f"poses of its frames in {METADATA}",
        shares_view=True,
    )


def _pose(values: Any) -> np.ndarray:
    """Return the optical frame's pose of quaternion xyzw and position, or of a 4 x 4 matrix."""
    numbers = np.array(values, np.float64)
    if numbers.shape == (4, 4):
        return np.asarray(numbers @ FROM_OPENGL)
    if numbers.shape != (7,):
        raise ValueError(f"a pose has the shape {numbers.shape}")
    norm = float(np.linalg.norm(numbers[:4]))
    if not norm > 0.0:
        return np.full((4, 4), np.nan)
    return np.asarray(rigid_matrix(numbers[4:], numbers[:4] / norm) @ FROM_OPENGL)
