# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""nerfstudio folders: transforms.json with depth maps.

Poses are camera-to-world of OpenGL cameras (z backwards, y up), turned here to optical frames.
Integer depth is in millimetres, floats (npy, exr) are in metres; depth maps of another size show
the colour images' view. Camera models OPENCV (and its simple forms) and OPENCV_FISHEYE are read,
for the whole capture or for each frame.
"""

from __future__ import annotations

import json
import math
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.capture.folders.files import (
    FRAME_RATE,
    UNREADABLE,
    Pinhole,
    camera_info,
    colour_message,
    depth_message,
    image_size,
    read_text,
)
from reflest_core.capture.folders.frame_folder import FolderFrame, FrameFolder
from reflest_core.capture.messages import CameraInfoMessage
from reflest_core.capture.refusal import CaptureError

TRANSFORMS = "transforms.json"
FROM_OPENGL = np.diag([1.0, -1.0, -1.0, 1.0])
PLUMB_BOB, FISHEYE = ("k1", "k2", "p1", "p2", "k3"), ("k1", "k2", "k3", "k4")
CAMERA_KEYS = (
    *("camera_model", "fl_x", "fl_y", "cx", "cy", "w", "h", "camera_angle_x"),
    *(*PLUMB_BOB, "k4"),
)


def open_nerfstudio(folder: Path, pinhole: Pinhole | None) -> FrameFolder:
    """Return the frames of a folder, sorted by their images' names.

    Args:
        folder: The folder with transforms.json.
        pinhole: fx, fy, cx, cy in pixels in place of the file's; distortion stays the file's.

    Raises:
        CaptureError: transforms.json is damaged, names no depth or an unknown camera model.
    """
    path = folder / TRANSFORMS
    try:
        document: dict[str, Any] = json.loads(read_text(path))
        listed = sorted(document["frames"], key=lambda frame: str(frame["file_path"]))
        if not any("depth_file_path" in frame for frame in listed):
            raise CaptureError(f"{path} has no depth_file_path: reflest needs depth maps")
        frames: list[FolderFrame] = []
        shared: CameraInfoMessage | None = None
        for index, frame in enumerate(listed):
            stamp_ns = index * 10**9 // FRAME_RATE
            colour = _image_path(folder, str(frame["file_path"]))
            if any(key in frame for key in CAMERA_KEYS):
                info = _camera({**document, **frame}, colour, pinhole, path)
            else:
                info = shared = shared or _camera(document, colour, pinhole, path)
            depth = frame.get("depth_file_path")
            matrix = np.array(frame["transform_matrix"], np.float64)
            if matrix.shape != (4, 4):
                raise ValueError("a transform_matrix is not 4 x 4")
            frames.append(
                FolderFrame(
                    stamp_ns,
                    partial(colour_message, colour, stamp_ns),
                    None if depth is None else partial(depth_message, folder / depth, stamp_ns),
                    matrix @ FROM_OPENGL,
                    info,
                )
            )
    except UNREADABLE as error:
        reason = f"{error.args[0]} is missing" if isinstance(error, KeyError) else str(error)
        raise CaptureError(f"{path} cannot be read: {reason}") from error
    common = frames[0].camera_info if frames else None
    if common is None:
        raise CaptureError(f"{path} lists no frames")
    return FrameFolder(
        folder, frames, common, 0.001, "depth_file_path", "transform_matrix", shares_view=True
    )


def _image_path(folder: Path, name: str) -> Path:
    """Return an image's path; Blender's names leave the suffix out."""
    path = folder / name
    return path if path.suffix else path.with_name(f"{path.name}.png")


def _camera(
    values: dict[str, Any], colour: Path, pinhole: Pinhole | None, path: Path
) -> CameraInfoMessage:
    size = (int(values["w"]), int(values["h"])) if "w" in values else image_size(colour)
    if min(size) < 1:
        raise ValueError(f"w and h are {size}")
    if pinhole is None:
        if "fl_x" in values:
            fx = float(values["fl_x"])
        else:
            fx = 0.5 * size[0] / math.tan(0.5 * float(values["camera_angle_x"]))
        pinhole = (
            fx,
            float(values.get("fl_y", fx)),
            float(values.get("cx", size[0] / 2)),
            float(values.get("cy", size[1] / 2)),
        )
    model = str(values.get("camera_model", "OPENCV"))
    if model == "OPENCV_FISHEYE":
        return camera_info(pinhole, size, _coefficients(values, FISHEYE), "equidistant")
    if model not in ("OPENCV", "PINHOLE", "SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL"):
        raise CaptureError(
            f"{path} has the camera model {model}; read are OPENCV, PINHOLE and OPENCV_FISHEYE"
        )
    coefficients = _coefficients(values, PLUMB_BOB)
    return camera_info(pinhole, size, coefficients if any(coefficients) else ())


def _coefficients(values: dict[str, Any], names: tuple[str, ...]) -> tuple[float, ...]:
    return tuple(float(values.get(name, 0.0)) for name in names)
