# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Images on disk: OpenEXR for linear light and normals, PNG and JPEG for what a camera shows.

Importing this module loads Mitsuba, which writes OpenEXR.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.path_tracing.mitsuba_runtime import load_mitsuba

mi: Any = load_mitsuba()

MILLIMETRES = 1000.0


def write_exr(path: Path, image: NDArray[np.float32]) -> None:
    """Write an image in 32-bit floats.

    Args:
        path: the file.
        image: (H, W, 3) float32.

    Raises:
        OSError: It cannot be written.
    """
    try:
        mi.Bitmap(np.ascontiguousarray(image, np.float32)).write(str(path))
    except RuntimeError as error:
        raise OSError(str(error)) from error


def write_rgb(path: Path, image: NDArray[np.uint8], quality: int | None = None) -> None:
    """Write an image as .png, or as .jpg.

    Args:
        path: the file.
        image: (H, W, 3) uint8 sRGB.
        quality: of JPEG, 1 to 100; None for PNG.
    """
    options = [] if quality is None else [cv2.IMWRITE_JPEG_QUALITY, quality]
    _write(path, image[..., ::-1], options)


def write_depth(path: Path, depth: NDArray[np.float32]) -> None:
    """Write depth as a 16-bit .png in millimetres, as 7-Scenes and ROS do.

    Args:
        path: the file.
        depth: (H, W) metres, 0 where unknown.
    """
    _write(path, np.rint(depth * MILLIMETRES).astype(np.uint16), [])


def write_mask(path: Path, mask: NDArray[np.bool_]) -> None:
    """Write a mask as an 8-bit .png of 0 and 255.

    Args:
        path: the file.
        mask: (H, W) bool.
    """
    _write(path, np.where(mask, np.uint8(255), np.uint8(0)), [])


def _write(path: Path, image: NDArray[Any], options: list[int]) -> None:
    is_encoded, data = cv2.imencode(path.suffix, np.ascontiguousarray(image), options)
    if not is_encoded:
        raise OSError(f"{path.name} cannot be encoded")
    path.write_bytes(data.tobytes())
