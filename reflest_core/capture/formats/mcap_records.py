# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""MCAP's records one by one, as far as the bytes go (mcap.dev/spec).

The ``mcap`` package gives a chunk whole or not at all; a recording that was cut off still holds
the messages before the cut.
"""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator
from typing import IO, NamedTuple

import lz4.frame  # type: ignore[import-untyped]
import zstandard
from mcap.opcode import Opcode

RECORD_HEADER = struct.Struct("<BQ")  # opcode, length
CHUNK_HEADER = struct.Struct("<QQQII")  # first time, last time, size, CRC, length of compression
LARGEST_CHUNK = 2**30  # bytes unpacked; a larger one is a damaged size, not something to allocate


class McapDamage(Exception):
    """The file goes no further than this; the message says why."""


class Record(NamedTuple):
    """One record.

    Attributes:
        offset: Where it starts in its file or chunk.
        opcode: Its kind.
        content: Its bytes.
    """

    offset: int
    opcode: int
    content: bytes


def read_records(stream: IO[bytes], offset: int) -> Iterator[Record]:
    """Yield records; a chunk that is cut off comes too, with what is there.

    Args:
        stream: The file.
        offset: Where the first record starts.

    Yields:
        The records one after the other.

    Raises:
        McapDamage: Where the file ends within a record.
    """
    end = stream.seek(0, io.SEEK_END)
    while True:
        opcode, length = _header(stream, offset, end)
        content = stream.read(min(length, end - offset))
        is_cut = len(content) < length
        if not is_cut or opcode == Opcode.CHUNK:
            yield Record(offset, opcode, content)
        if is_cut:
            raise McapDamage("it is cut off")
        offset += RECORD_HEADER.size + length


def has_loose_messages(stream: IO[bytes], offset: int, chunks: dict[int, int]) -> bool:
    """Check whether a file with chunks also holds messages outside of them.

    Args:
        stream: The file.
        offset: Where its first record starts.
        chunks: By the offset of each chunk, the offset after it and its message indexes.

    Raises:
        McapDamage: Where the file ends before its data section does.
    """
    end = stream.seek(0, io.SEEK_END)
    while True:
        opcode, length = _header(stream, offset, end)
        if opcode in (Opcode.MESSAGE, Opcode.DATA_END):
            return opcode == Opcode.MESSAGE
        offset = max(chunks.get(offset, 0), offset + RECORD_HEADER.size + length)


def _header(stream: IO[bytes], offset: int, end: int) -> tuple[int, int]:
    """Return opcode and length of the record at an offset; content comes next in the stream."""
    if offset + RECORD_HEADER.size > end:
        raise McapDamage("it is cut off")
    stream.seek(offset)
    opcode, length = RECORD_HEADER.unpack(stream.read(RECORD_HEADER.size))
    if length > 2**62:
        raise McapDamage("a record's length is garbage")
    return opcode, length


def chunk_start_ns(content: bytes) -> int:
    """Return the log time of a chunk's first message; 0 where it is cut off before that.

    Args:
        content: a chunk record.
    """
    return int.from_bytes(content[:8], "little") if len(content) >= CHUNK_HEADER.size else 0


def read_chunk(content: bytes) -> Iterator[Record]:
    """Yield the records in a chunk, up to the place where it is cut off or damaged.

    Args:
        content: a chunk record.

    Raises:
        McapDamage: at that place.
    """
    if len(content) < CHUNK_HEADER.size:
        raise McapDamage("it is cut off")
    _, _, size, crc, name_length = CHUNK_HEADER.unpack_from(content)
    data_start = CHUNK_HEADER.size + name_length + 8
    compression = content[CHUNK_HEADER.size : CHUNK_HEADER.size + name_length]
    if size > LARGEST_CHUNK:
        raise McapDamage(f"a chunk claims to hold {size} bytes, more than {LARGEST_CHUNK}")
    data = _unpacked(compression, content[data_start:], size)
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
    if offset != size:
        raise McapDamage("it is cut off" if len(data) < size else "a chunk holds garbage")


def _unpacked(compression: bytes, data: bytes, size: int) -> bytes:
    """Return what can be unpacked of the chunk's data, all of it if nothing is missing.

    No more than one byte past the declared size is unpacked, whatever the data claim.
    """
    try:
        if compression == b"":
            return data
        if compression == b"zstd":
            reader = zstandard.ZstdDecompressor().stream_reader(data, read_across_frames=True)
            return reader.read(size + 1)
        if compression == b"lz4":
            return bytes(lz4.frame.LZ4FrameDecompressor().decompress(data, max_length=size + 1))
    except (zstandard.ZstdError, RuntimeError, EOFError) as error:
        raise McapDamage(f"a chunk cannot be unpacked: {error}") from error
    raise McapDamage(f"a chunk has the unknown compression {compression!r}")
