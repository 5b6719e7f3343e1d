# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Calibration of a folder of frames: a file beside them, or four numbers from the user."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from reflest_core.capture.images.compressed_header import read_header
from reflest_core.capture.messages import CameraInfoMessage
from reflest_core.capture.refusal import CaptureError

FILE_NAME = "camera-intrinsics.txt"
Pinhole = tuple[float, float, float, float]


def folder_camera_info(
    folder: Path, image: Path, stamp_ns: int, pinhole: Pinhole | None
) -> CameraInfoMessage:
    """Return the calibration of the images in ``folder``, sized as ``image``.

    ``pinhole`` is fx, fy, cx, cy in pixels; None reads the 3 x 3 matrix in
    ``camera-intrinsics.txt`` in the folder or its parent.

    Raises:
        CaptureError: if there is no calibration, or the image or the file cannot be read.
    """
    header = read_header(image.read_bytes())
    if header is None:
        raise CaptureError(f"{image} is neither a jpeg nor a png")
    if pinhole is None:
        pinhole = _read_pinhole(folder)
    fx, fy, cx, cy = pinhole
    matrix = (fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0)
    return CameraInfoMessage(stamp_ns, "", header.width, header.height, matrix)


def _read_pinhole(folder: Path) -> Pinhole:
    for path in (folder / FILE_NAME, folder.absolute().parent / FILE_NAME):
        if not path.is_file():
            continue
        try:
            matrix = np.loadtxt(path)
        except ValueError:
            matrix = np.empty(0)
        if matrix.shape != (3, 3):
            raise CaptureError(f"{path} does not hold a 3 x 3 camera matrix")
        return float(matrix[0, 0]), float(matrix[1, 1]), float(matrix[0, 2]), float(matrix[1, 2])
    raise CaptureError(
        f"{folder} has no {FILE_NAME} (3 x 3 matrix): add it or give --intrinsics FX FY CX CY"
    )
