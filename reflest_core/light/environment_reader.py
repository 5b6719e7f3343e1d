# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Reading light from ``.hdr`` and ``.exr`` files."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


def read_radiance(path: Path) -> NDArray[np.float32]:
    """(H, W, 3) linear radiance.

    Raises :class:`ValueError` where it cannot be decoded.
    """
    # OpenCV reads OpenEXR only where the process asks for it.
    os.environ["OPENCV_IO_ENABLE_OPENEXR"] = "1"
    import cv2

    image = cv2.imread(str(path), cv2.IMREAD_ANYDEPTH | cv2.IMREAD_COLOR)
    if image is None:
        raise ValueError("it is not an .hdr or .exr image that OpenCV can decode")
    return np.asarray(image[..., ::-1], np.float32)
