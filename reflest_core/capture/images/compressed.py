# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Compressed images: jpeg and png; 16-bit png depth and compressedDepth (png, rvl)."""

from __future__ import annotations

import struct

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.images.compressed_header import (
    MOST_PIXELS,
    CompressedHeader,
    read_header,
)
from reflest_core.capture.images.rvl import decode_rvl
from reflest_core.capture.messages import AnyImage, CompressedImageMessage, ImageMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause

# compressedDepth's ConfigHeader: int32 format, then float32 a and b with depth = a / (value - b).
DEPTH_HEADER = struct.Struct("<iff")
RVL_SIZE = struct.Struct("<II")  # columns, rows
PEEKED = 4096  # bytes in which a header mostly stands


def decode_compressed_colour(message: CompressedImageMessage, topic: str) -> NDArray[np.uint8]:
    """Return (H, W, 3) uint8 RGB of a jpeg or an 8-bit png.

    Args:
        message: as it was received or recorded.
        topic: how sentences name the stream.

    Raises:
        FrameRefused: ENCODING, SIZE or TRUNCATED.
    """
    data = bytes(message.data)
    header = _checked_header(data, message, topic)
    if "compressedDepth" in message.format or header.bit_depth != 8:
        raise _unsupported(message, topic, "colour: publish jpeg or 8-bit png")
    flags = cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION
    bgr = _unpack(data, flags, header, message, topic)
    return np.ascontiguousarray(bgr[:, :, ::-1], dtype=np.uint8)


def decode_compressed_depth(
    message: CompressedImageMessage, topic: str
) -> NDArray[np.uint16] | NDArray[np.float32]:
    """Return (H, W) uint16 units, or float32 metres where the message says ``32FC1``.

    Args:
        message: as it was received or recorded.
        topic: how sentences name the stream.

    Raises:
        FrameRefused: ENCODING, SIZE or TRUNCATED.
    """
    data = bytes(message.data)
    a, b = 0.0, 0.0
    if "compressedDepth" in message.format:
        if len(data) < DEPTH_HEADER.size:
            raise _cut_off(message, topic)
        _, a, b = DEPTH_HEADER.unpack_from(data)
        data = data[DEPTH_HEADER.size :]
    is_rvl = message.format.endswith("compressedDepth rvl")
    units = _rvl_units(data, message, topic) if is_rvl else _png_units(data, message, topic)
    if not message.format.startswith("32FC1"):
        return units
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        metres = np.float32(a) / (units.astype(np.float32) - np.float32(b))
    return np.where(units == 0, np.float32(0.0), metres)


def pixel_size(message: AnyImage) -> tuple[int, int] | None:
    """Return width and height of an image; a compressed one is not unpacked.

    Args:
        message: Any image.

    Returns:
        The size in pixels, or None where a compressed image's header cannot be read.
    """
    if isinstance(message, ImageMessage):
        return message.width, message.height
    start = DEPTH_HEADER.size if "compressedDepth" in message.format else 0
    data = np.frombuffer(message.data, np.uint8)[start:]
    if message.format.endswith("compressedDepth rvl"):
        return RVL_SIZE.unpack_from(data.tobytes()) if len(data) >= RVL_SIZE.size else None
    header = read_header(data[:PEEKED].tobytes()) or read_header(data.tobytes())
    return (header.width, header.height) if header else None


def _png_units(data: bytes, message: CompressedImageMessage, topic: str) -> NDArray[np.uint16]:
    header = _checked_header(data, message, topic)
    if header.kind != "png" or header.bit_depth != 16 or header.channels != 1:
        raise _unsupported(message, topic, "depth: publish 16-bit png or compressedDepth")
    return _unpack(data, cv2.IMREAD_UNCHANGED, header, message, topic).astype(np.uint16)


def _rvl_units(data: bytes, message: CompressedImageMessage, topic: str) -> NDArray[np.uint16]:
    if len(data) < RVL_SIZE.size:
        raise _cut_off(message, topic)
    width, height = RVL_SIZE.unpack_from(data)
    _check_pixel_count(width, height, topic)
    units = decode_rvl(data[RVL_SIZE.size :], height, width)
    if units is None:
        raise _cut_off(message, topic)
    return units


def decode_compressed_mask(message: CompressedImageMessage, topic: str) -> NDArray[np.uint8]:
    """Return (H, W) uint8 of an 8-bit single-channel png (jpeg would blur the outline).

    Args:
        message: as it was received or recorded.
        topic: how sentences name the stream.

    Raises:
        FrameRefused: ENCODING, SIZE or TRUNCATED.
    """
    data = bytes(message.data)
    header = _checked_header(data, message, topic)
    if header.kind != "png" or header.bit_depth != 8 or header.channels != 1:
        raise _unsupported(message, topic, "mask: publish 8-bit single-channel png")
    return _unpack(data, cv2.IMREAD_UNCHANGED, header, message, topic).astype(np.uint8)


def _checked_header(data: bytes, message: CompressedImageMessage, topic: str) -> CompressedHeader:
    header = read_header(data)
    if header is None:
        if not data:
            raise _cut_off(message, topic)
        raise _unsupported(message, topic, "an image: publish jpeg or png")
    _check_pixel_count(header.width, header.height, topic)
    # Decoders fill what is missing with grey and say nothing, so the end must be there.
    if not header.is_complete:
        raise _cut_off(message, topic)
    return header


def _check_pixel_count(width: int, height: int, topic: str) -> None:
    if not 0 < width * height <= MOST_PIXELS:
        raise FrameRefused(
            RefusalCause.SIZE,
            f"{topic}: a compressed image of {width} x {height} pixels is refused, the limit is "
            f"{MOST_PIXELS} pixels",
        )


def _unpack(
    data: bytes, flags: int, header: CompressedHeader, message: CompressedImageMessage, topic: str
) -> NDArray[np.generic]:
    try:
        image = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), flags)
    except cv2.error:
        image = None
    if image is None or image.shape[:2] != (header.height, header.width):
        raise _cut_off(message, topic)
    return image


def _unsupported(message: CompressedImageMessage, topic: str, wanted: str) -> FrameRefused:
    return FrameRefused(
        RefusalCause.ENCODING,
        f"{topic} has format {message.format!r}, which is not read as {wanted}",
    )


def _cut_off(message: CompressedImageMessage, topic: str) -> FrameRefused:
    return FrameRefused(
        RefusalCause.TRUNCATED,
        f"{topic}: the {message.format!r} image of {len(message.data)} bytes is cut off or damaged",
    )
