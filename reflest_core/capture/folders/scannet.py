# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""ScanNet as its reader exports it: color/0.jpg, depth/0.png, pose/0.txt, intrinsic/*.txt.

Depth is in millimetres, smaller than colour, with a calibration of its own; both cameras are taken
to stand in one place, as ScanNet's own tools do. Poses are 4 x 4 camera-to-world matrices, -inf
where tracking was lost.
"""

from __future__ import annotations

from pathlib import Path

from reflest_core.capture.folders.files import (
    Pinhole,
    by_number,
    camera_info,
    folder_pinhole,
    image_size,
    pose_in,
)
from reflest_core.capture.folders.frame_folder import FrameFolder, numbered_frames
from reflest_core.capture.refusal import CaptureError

COLOUR, DEPTH, POSE = "color", "depth", "pose"


def open_scannet(folder: Path, pinhole: Pinhole | None) -> FrameFolder:
    """Return the frames of one exported scan.

    Args:
        folder: The folder.
        pinhole: fx, fy, cx, cy of the colour images in pixels; None reads the folder's.

    Raises:
        CaptureError: There is no frame or no calibration.
    """
    colours = by_number(folder / COLOUR, r"(\d+)\.(?:jpe?g|png)")
    depths = by_number(folder / DEPTH, r"(\d+)\.(?:png|pgm|tiff?)")
    if not colours or not depths:
        raise CaptureError(f"{folder} holds no {COLOUR}/*.jpg or no {DEPTH}/*.png")
    place = folder / "intrinsic"
    place = place if place.is_dir() else folder
    if pinhole is None:
        pinhole = folder_pinhole(place, ("intrinsic_color.txt", "camera-intrinsics.txt"))
    poses = {index: folder / POSE / f"{colour.stem}.txt" for index, colour in colours.items()}
    frames = numbered_frames(colours, depths, lambda index: pose_in(poses[index]))
    size, depth_size = (image_size(next(iter(files.values()))) for files in (colours, depths))
    depth_info = None
    if depth_size != size and (place / "intrinsic_depth.txt").is_file():
        depth_info = camera_info(folder_pinhole(place, ("intrinsic_depth.txt",)), depth_size)
    return FrameFolder(
        folder,
        frames,
        camera_info(pinhole, size),
        0.001,
        f"{DEPTH}/*.png of its frames",
        f"{POSE}/*.txt of its frames",
        depth_info,
        depth_info is None,
    )
