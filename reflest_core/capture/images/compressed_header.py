# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Size and type of a jpeg or png, read without unpacking it."""

from __future__ import annotations

import struct
from dataclasses import dataclass

PNG_MAGIC = b"\x89PNG\r\n\x1a\n"
JPEG_MAGIC = b"\xff\xd8\xff"
JPEG_END = b"\xff\xd9"
# Start-of-frame markers carry the size; C4, C8 and CC share the range but mean other things.
START_OF_FRAME = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
MOST_PIXELS = 2**26  # a larger image is refused before it is unpacked into memory
FRAME_HEADER = 10  # bytes from its marker to the number of channels
PNG_CHUNK = struct.Struct(">I4s")  # length and type; then come the content and its CRC
PNG_CRC_BYTES = 4
PNG_CHANNELS = {0: 1, 2: 3, 3: 3, 4: 2, 6: 4}  # by colour type; a palette unpacks to three


@dataclass(frozen=True)
class CompressedHeader:
    """What a header says.

    Attributes:
        kind: jpeg or png.
        width: Columns.
        height: Rows.
        bit_depth: Of each channel.
        channels: When unpacked.
        is_complete: Whether the end is there, and all parts are as long as they declare: OpenCV
            takes memory for what a part declares.
    """

    kind: str
    width: int
    height: int
    bit_depth: int
    channels: int
    is_complete: bool


def read_header(data: bytes) -> CompressedHeader | None:
    """Return the header of a jpeg or png, or None where ``data`` starts as neither.

    Args:
        data: the encoded image.
    """
    if data.startswith(PNG_MAGIC):
        return _read_png(data)
    if data.startswith(JPEG_MAGIC):
        return _read_jpeg(data)
    return None


def _read_png(data: bytes) -> CompressedHeader | None:
    if len(data) < 26 or data[12:16] != b"IHDR":
        return None
    width, height, bit_depth, colour_type = struct.unpack_from(">IIBB", data, 16)
    channels = PNG_CHANNELS.get(colour_type, 0)
    if bit_depth < 8:  # one to four bits of palette or grey unpack to eight
        bit_depth = 8
    return CompressedHeader("png", width, height, bit_depth, channels, _has_all_chunks(data))


def _has_all_chunks(png: bytes) -> bool:
    """Whether each chunk to the end lies within the data, and none begins an animation."""
    position = len(PNG_MAGIC)
    while position + PNG_CHUNK.size <= len(png):
        length, kind = PNG_CHUNK.unpack_from(png, position)
        position += PNG_CHUNK.size + length + PNG_CRC_BYTES
        if position > len(png) or kind in (b"acTL", b"fcTL"):
            return False
        if kind == b"IEND":
            return True
    return False


def _read_jpeg(data: bytes) -> CompressedHeader | None:
    position = 2
    while position + FRAME_HEADER <= len(data):
        if data[position] != 0xFF:
            return None
        marker = data[position + 1]
        if marker == 0xFF:  # fill byte
            position += 1
            continue
        if marker in START_OF_FRAME:
            bit_depth, height, width, channels = struct.unpack_from(">BHHB", data, position + 4)
            # Not before here, where a thumbnail may end; what follows the end is padding.
            is_complete = data.rfind(JPEG_END, position) >= 0
            return CompressedHeader("jpeg", width, height, bit_depth, channels, is_complete)
        position += 2 + int(struct.unpack_from(">H", data, position + 2)[0])
    return None
