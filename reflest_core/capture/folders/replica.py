# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Replica as rendered for iMAP and NICE-SLAM: results/frame000000.jpg, depth000000.png, traj.txt.

``traj.txt`` has a camera-to-world matrix a line, 16 numbers, row by row. ``cam_params.json``, in
the folder or above it, has the calibration and how many units of depth a metre has (6553.5).
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

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
from reflest_core.capture.refusal import CaptureError

TRAJECTORY, IMAGES, CAMERA = "traj.txt", "results", "cam_params.json"
UNITS_A_METRE = 6553.5
MOST_UNITS = 1e6


def open_replica(folder: Path, pinhole: Pinhole | None) -> FrameFolder:
    """Return the frames of one scene.

    Args:
        folder: The folder with traj.txt and results.
        pinhole: fx, fy, cx, cy in pixels; None reads cam_params.json or camera-intrinsics.txt.

    Raises:
        CaptureError: A line of traj.txt is no matrix, or there is no frame or no calibration.
    """
    colours = by_number(folder / IMAGES, r"frame(\d+)\.(?:jpe?g|png)")
    depths = by_number(folder / IMAGES, r"depth(\d+)\.png")
    if not colours:
        raise CaptureError(f"{folder} holds no {IMAGES}/frame*.jpg")
    poses = []
    for number, line in enumerate(read_text(folder / TRAJECTORY).splitlines(), start=1):
        try:
            poses.append(np.array([float(word) for word in line.split()]).reshape(4, 4))
        except ValueError as error:
            raise CaptureError(
                f"{folder / TRAJECTORY}, line {number}: expected 16 numbers"
            ) from error
    camera = _camera(folder)
    if pinhole is None and camera:
        pinhole = camera["fx"], camera["fy"], camera["cx"], camera["cy"]
    if pinhole is None:
        pinhole = folder_pinhole(folder)
    frames = numbered_frames(
        colours, depths, lambda index: poses[index] if index < len(poses) else None
    )
    size = image_size(next(iter(colours.values())))
    scale = 1.0 / float(camera.get("scale", UNITS_A_METRE))
    depths_at, poses_at = f"{IMAGES}/depth*.png", f"poses of its frames in {TRAJECTORY}"
    return FrameFolder(folder, frames, camera_info(pinhole, size), scale, depths_at, poses_at)


def _camera(folder: Path) -> dict[str, float]:
    for path in (folder / CAMERA, folder.absolute().parent / CAMERA):
        if not path.is_file():
            continue
        try:
            content: dict[str, Any] = json.loads(read_text(path))["camera"]
            camera = {name: float(content[name]) for name in ("fx", "fy", "cx", "cy")}
            scale = float(content.get("scale", UNITS_A_METRE))
            if not 1.0 <= scale <= MOST_UNITS:
                raise ValueError(f"scale is {scale}")
            return camera | {"scale": scale}
        except UNREADABLE as error:
            raise CaptureError(f"{path} does not hold fx, fy, cx, cy under camera") from error
    return {}
