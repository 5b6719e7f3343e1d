# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Image messages to arrays: colour as 8-bit RGB, depth in metres; other encodings are refused.

``step`` and endianness are honoured. Units are never guessed: ``32FC1`` is metres and ``16UC1``
counts ``depth_scale`` metres.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.images.compressed import (
    decode_compressed_colour,
    decode_compressed_depth,
    decode_compressed_mask,
)
from reflest_core.capture.messages import AnyImage, CompressedImageMessage, ImageMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause

# Bytes of a pixel, and OpenCV's conversion to red, green and blue.
COLOUR_ENCODINGS: dict[str, tuple[int, int | None]] = {
    "rgb8": (3, None),
    "bgr8": (3, cv2.COLOR_BGR2RGB),
    "rgba8": (4, cv2.COLOR_RGBA2RGB),
    "bgra8": (4, cv2.COLOR_BGRA2RGB),
    "mono8": (1, cv2.COLOR_GRAY2RGB),
    "bayer_rggb8": (1, cv2.COLOR_BayerRGGB2RGB),
    "bayer_bggr8": (1, cv2.COLOR_BayerBGGR2RGB),
    "bayer_gbrg8": (1, cv2.COLOR_BayerGBRG2RGB),
    "bayer_grbg8": (1, cv2.COLOR_BayerGRBG2RGB),
    "yuv422": (2, cv2.COLOR_YUV2RGB_UYVY),
    "uyvy": (2, cv2.COLOR_YUV2RGB_UYVY),
    "yuv422_yuy2": (2, cv2.COLOR_YUV2RGB_YUYV),
    "yuyv": (2, cv2.COLOR_YUV2RGB_YUYV),
}
DEPTH_ENCODINGS = {"16UC1": np.uint16, "32FC1": np.float32, "mono16": np.uint16}
MASK_ENCODINGS = ("mono8", "8UC1")
NEAREST = 1e-3  # metres; no camera measures less, and fusion divides by depth
SATURATED = 65535  # in 16-bit depth: "further than I can count", or Kinect's "unknown"


def decode_colour(message: AnyImage, topic: str) -> NDArray[np.uint8]:
    """Return (H, W, 3) uint8, 8-bit sRGB, red first.

    Args:
        message: as it was received or recorded.
        topic: how sentences name the stream.

    Raises:
        FrameRefused: ENCODING, SIZE or TRUNCATED.
    """
    if isinstance(message, CompressedImageMessage):
        return decode_compressed_colour(message, topic)
    if message.encoding not in COLOUR_ENCODINGS:
        raise _unsupported(message.encoding, topic, COLOUR_ENCODINGS, "colour", "--rgb-topic")
    pixel_bytes, conversion = COLOUR_ENCODINGS[message.encoding]
    rows = _pixel_rows(message, pixel_bytes, topic)
    pixels = rows.reshape(message.height, message.width, pixel_bytes)
    if conversion is None:
        return pixels.copy()
    if pixel_bytes == 2 and message.width % 2:
        raise FrameRefused(
            RefusalCause.SIZE,
            f"{topic}: {message.encoding} needs an even width, not {message.width}: check the "
            "camera driver's image message",
        )
    return np.asarray(cv2.cvtColor(np.ascontiguousarray(pixels), conversion), np.uint8)


def decode_depth(
    message: AnyImage, topic: str, depth_scale: float, is_rotated: bool = False
) -> NDArray[np.float32]:
    """Return depth in metres.

    Args:
        message: A depth image.
        topic: Its topic, for sentences.
        depth_scale: Metres in one unit of 16-bit depth.
        is_rotated: The three lowest bits of 16-bit depth stand at the top.

    Returns:
        (H, W) float32 metres; 0 where depth is NaN, infinite, not positive or saturated.

    Raises:
        FrameRefused: ENCODING, SIZE or TRUNCATED.
    """
    if isinstance(message, CompressedImageMessage):
        return _metres(decode_compressed_depth(message, topic), depth_scale, is_rotated)
    if message.encoding not in DEPTH_ENCODINGS:
        raise _unsupported(message.encoding, topic, DEPTH_ENCODINGS, "depth", "--depth-topic")
    native = np.dtype(DEPTH_ENCODINGS[message.encoding])
    rows = _pixel_rows(message, native.itemsize, topic)
    sent = native.newbyteorder(">" if message.is_bigendian else "<")
    return _metres(np.ascontiguousarray(rows).view(sent).astype(native), depth_scale, is_rotated)


def decode_mask(message: AnyImage, topic: str) -> NDArray[np.bool_]:
    """Return (H, W) bool, True where the mask is not 0.

    Args:
        message: as it was received or recorded.
        topic: how sentences name the stream.

    Raises:
        FrameRefused: ENCODING, SIZE or TRUNCATED.
    """
    if isinstance(message, CompressedImageMessage):
        return np.not_equal(decode_compressed_mask(message, topic), 0)
    if message.encoding not in MASK_ENCODINGS:
        raise _unsupported(message.encoding, topic, MASK_ENCODINGS, "mask", "--mask-topic")
    return np.not_equal(_pixel_rows(message, 1, topic), 0)


def _unsupported(
    encoding: str, topic: str, supported: Iterable[str], kind: str, option: str
) -> FrameRefused:
    return FrameRefused(
        RefusalCause.ENCODING,
        f"{topic} has encoding {encoding!r}, which is not read as {kind}: publish one of "
        f"{', '.join(supported)}, or choose another topic ({option})",
    )


def _pixel_rows(message: ImageMessage, pixel_bytes: int, topic: str) -> NDArray[np.uint8]:
    """Return the (H, W * pixel_bytes) bytes of the pixels without the rows' padding."""
    height, width, step = message.height, message.width, message.step
    data = np.frombuffer(message.data, dtype=np.uint8)
    is_wide_enough = height > 0 and width > 0 and step >= width * pixel_bytes
    if not is_wide_enough or data.size > step * height:
        raise FrameRefused(
            RefusalCause.SIZE,
            f"{topic}: {width} x {height} {message.encoding} pixels do not fit step {step} and "
            f"{data.size} bytes: check the camera driver's image message",
        )
    if data.size < step * height:
        raise FrameRefused(
            RefusalCause.TRUNCATED,
            f"{topic}: the image holds {data.size} of {step * height} bytes: it was cut off in "
            "the driver or on the way",
        )
    return data.reshape(height, step)[:, : width * pixel_bytes]


@functools.lru_cache(maxsize=4)
def _metres_by_unit(depth_scale: float, is_rotated: bool) -> NDArray[np.float32]:
    units = np.arange(SATURATED + 1)
    if is_rotated:
        units = (units >> 3) | ((units << 13) & SATURATED)
    # Multiplied in double precision, so that 16UC1 equals a 32FC1 image of the same metres.
    table = (units * depth_scale).astype(np.float32)
    table[SATURATED] = 0.0
    return table


def _metres(
    raw: NDArray[np.uint16] | NDArray[np.float32], depth_scale: float, is_rotated: bool
) -> NDArray[np.float32]:
    if raw.dtype == np.uint16:
        return _metres_by_unit(depth_scale, is_rotated).take(np.asarray(raw, np.uint16))
    return np.where(np.isfinite(raw) & (raw >= NEAREST), raw, 0.0).astype(np.float32)
