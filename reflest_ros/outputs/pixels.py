# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Arrays of pixels as ``sensor_msgs/Image``."""

from __future__ import annotations

import array
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import Image

from reflest_ros.inputs.core_messages import ns_to_stamp


def pixels_message(pixels: NDArray[Any], encoding: str, frame_id: str, stamp_ns: int) -> Image:
    """Make an image.

    Args:
        pixels: (H, W) or (H, W, C), of the type that the encoding names.
        encoding: A name of ``sensor_msgs/image_encodings``.
        frame_id: Of the header.
        stamp_ns: Of the header, nanoseconds.

    Returns:
        The message, without padding between rows.
    """
    packed = np.ascontiguousarray(pixels)
    message = Image(
        height=packed.shape[0],
        width=packed.shape[1],
        encoding=encoding,
        is_bigendian=int(sys.byteorder == "big"),
        step=packed.strides[0],
    )
    message.header.stamp = ns_to_stamp(stamp_ns)
    message.header.frame_id = frame_id
    message.data = array.array("B", packed.tobytes())
    return message
