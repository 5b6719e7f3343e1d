# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""MCAP's records one by one, as far as the bytes go (mcap.dev/spec).

The ``mcap`` package gives a chunk whole or not at all; a recording that was cut off still holds
the messages before the cut.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from typing import IO, NamedTuple

import lz4.frame  # type: ignore[import-untyped]
import zstandard
from mcap.opcode import Opcode

RECORD_HEADER = struct.Struct("<BQ")  # opcode, length
CHUNK_HEADER = struct.Struct("<QQQII")  # first time, last time, size, CRC, length of compression
LONGEST_RECORD = 2**32  # a longer one is a damaged length, not something to allocate


class McapDamage(Exception):
    """The file goes no further than this; the message says why."""


class Record(NamedTuple):
    """One record: where it starts in its file or chunk, its opcode, its content."""

    offset: int
    opcode: int
    content: bytes


def read_records(stream: IO[bytes], offset: int) -> Iterator[Record]:
    """Yield records from ``offset`` on; a chunk that is cut off comes too, with what is there.

    Raises:
        McapDamage: where the file ends within a record.
    """
    while True:
        stream.seek(offset)
        header = stream.read(RECORD_HEADER.size)
        if len(header) < RECORD_HEADER.size:
            raise McapDamage("it is cut off")
        opcode, length = RECORD_HEADER.unpack(header)
        if length > LONGEST_RECORD:
            raise McapDamage("a record's length is garbage")
        content = stream.read(length)
        is_cut = len(content) < length
        if not is_cut or opcode == Opcode.CHUNK:
            yield Record(offset, opcode, content)
        if is_cut:
            raise McapDamage("it is cut off")
        offset += RECORD_HEADER.size + length


def chunk_start_ns(content: bytes) -> int:
    """Return the log time of a chunk's first message; 0 where it is cut off before that."""
    return int.from_bytes(content[:8], "little") if len(content) >= CHUNK_HEADER.size else 0


def read_chunk(content: bytes) -> Iterator[Record]:
    """Yield the records in a chunk, up to the place where it is cut off or damaged.

    Raises:
        McapDamage: at that place.
    """
    if len(content) < CHUNK_HEADER.size:
        raise McapDamage("it is cut off")
    _, _, size, crc, name_length = CHUNK_HEADER.unpack_from(content)
    data_start = CHUNK_HEADER.size + name_length + 8
    compression = content[CHUNK_HEADER.size : CHUNK_HEADER.size + name_length]
    data = _unpacked(compression, content[data_start:])
    if len(data) == size and crc != 0 and zlib.crc32(data) != crc:
        raise McapDamage("a chunk does not match its checksum")
    offset = 0
    while offset + RECORD_HEADER.size <= len(data):
        opcode, length = RECORD_HEADER.unpack_from(data, offset)
        start = offset + RECORD_HEADER.size
        if start + length > len(data):
            break
        yield Record(offset, opcode, data[start : start + length])
        offset = start + length
    if offset < size:
        raise McapDamage("it is cut off" if len(data) < size else "a chunk holds garbage")


def _unpacked(compression: bytes, data: bytes) -> bytes:
    """Return what can be unpacked of the chunk's data, all of it if nothing is missing."""
    try:
        if compression == b"":
            return data
        if compression == b"zstd":
            return zstandard.ZstdDecompressor().decompressobj().decompress(data)
        if compression == b"lz4":
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(data))
    except (zstandard.ZstdError, RuntimeError, EOFError) as error:
        raise McapDamage(f"a chunk cannot be unpacked: {error}") from error
    raise McapDamage(f"a chunk has the unknown compression {compression!r}")
