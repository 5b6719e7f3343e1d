# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""MCAP files, whole or cut off, read in log-time order.

The index comes from the file's summary, or where there is none (a recorder that died), or it lacks
something (channels, schemas, counts and indexes are all optional), from one pass over the file.
Everything before damage is read.
"""

from __future__ import annotations

import heapq
import struct
from collections import Counter
from collections.abc import Collection, Iterator
from io import BytesIO
from pathlib import Path
from typing import IO

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import Channel, Schema
from mcap.summary import Summary

from reflest_core.capture.formats.bag_file import (
    BagTopic,
    RawMessage,
    damage_sentence,
    pointer_sentence,
)
from reflest_core.capture.formats.cdr import READERS
from reflest_core.capture.formats.mcap_records import (
    McapDamage,
    Record,
    chunk_start_ns,
    has_loose_messages,
    read_chunk,
    read_records,
)
from reflest_core.capture.refusal import CaptureError

MAGIC = b"\x89MCAP0\r\n"
NO_SCHEMA = 0
MESSAGE_HEADER = struct.Struct("<HIQQ")  # channel id, sequence, log time, publish time


class McapFile:
    """One MCAP file; ``damage`` is a sentence where it could not be read to its end."""

    def __init__(self, path: Path) -> None:
        """Read the summary, or where there is none the whole file once.

        Args:
            path: the file or folder.

        Raises:
            CaptureError: if it is not an MCAP file or holds no message that can be read.
        """
        self.damage: str | None = None
        self._path = path
        self._channels: dict[int, tuple[str, str]] = {}  # topic and message type by channel id
        self._schemas: dict[int, str] = {NO_SCHEMA: ""}
        self._is_ros1 = False
        self._index: list[tuple[int, int]] = []  # first log time and offset, chunk or message
        with path.open("rb") as stream:
            if stream.read(len(MAGIC)) != MAGIC:
                raise CaptureError(
                    pointer_sentence(path)
                    or f"{path} is not an MCAP file (or is cut off at its very start)"
                )
            summary = _read_summary(stream)
            self.topics = self._summarised(summary) if summary else self._scanned(stream)
        if self._is_ros1:
            raise CaptureError(
                f"{path} is a ROS 1 recording in MCAP: convert it to ROS 2 with rosbags-convert "
                "(from its .bag), or record it again through ros1_bridge"
            )
        if not any(topic.count for topic in self.topics):
            raise CaptureError(self.damage or f"{path} holds no messages")
        self._index.sort()

    def messages(self, topics: Collection[str]) -> Iterator[RawMessage]:
        """Yield the messages of ``topics`` up to the end or the damage.

        Args:
            topics: names of the topics to read.
        """
        waiting: list[tuple[int, int, RawMessage]] = []
        index, count = list(reversed(self._index)), 0
        first = last = None
        with self._path.open("rb") as stream:
            while index or waiting:
                # What starts before the next message may hold an earlier one.
                if index and (not waiting or index[-1][0] <= waiting[0][0]):
                    try:
                        for message in self._messages_at(stream, index.pop()[1]):
                            if message.topic in topics:
                                heapq.heappush(waiting, (message.log_time_ns, count, message))
                                count += 1
                    except McapDamage as damage:
                        index.clear()
                        times = [time for time, _, _ in waiting]
                        end = max(times, default=last)
                        start = min(times, default=None) if first is None else first
                        self.damage = damage_sentence(self._path.name, damage, start, end)
                    continue
                last, _, message = heapq.heappop(waiting)
                first = last if first is None else first
                yield message

    def _messages_at(self, stream: IO[bytes], offset: int) -> Iterator[RawMessage]:
        """Yield the messages of the chunk at ``offset``, or the one message there."""
        record = next(read_records(stream, offset))
        records = read_chunk(record.content) if record.opcode == Opcode.CHUNK else iter([record])
        for inner in records:
            if (message := self._note(inner)) is not None:
                yield message

    def _note(self, record: Record) -> RawMessage | None:
        """Return the message in a record, or remember what a schema or channel record says."""
        content = ReadDataStream(BytesIO(record.content))
        try:
            if record.opcode == Opcode.SCHEMA:
                schema = Schema.read(content)
                self._schemas[schema.id] = schema.name
            elif record.opcode == Opcode.CHANNEL:
                channel = Channel.read(content)
                self._take(channel, self._schemas[channel.schema_id])
            elif record.opcode == Opcode.MESSAGE:
                channel_id, _, log_time, _ = MESSAGE_HEADER.unpack_from(record.content)
                cdr = record.content[MESSAGE_HEADER.size :]
                return RawMessage(*self._channels[channel_id], log_time, cdr)
        except Exception as error:  # damaged content makes the parsers raise anything
            raise McapDamage(f"a record holds garbage: {error!r}") from error
        return None

    def _take(self, channel: Channel, schema: str) -> None:
        """Remember a channel; what is not CDR is of a type that no role can have."""
        kind = "/".join(part for part in schema.split("::") if part != "dds_")
        if kind.count("/") == 1:
            kind = kind.replace("/", "/msg/")
        if channel.message_encoding == "cdr":
            self._channels[channel.id] = (channel.topic, kind)
            return
        self._channels[channel.id] = (channel.topic, f"{channel.message_encoding} {schema}".strip())
        self._is_ros1 |= channel.message_encoding == "ros1" and kind in READERS

    def _summarised(self, summary: Summary) -> list[BagTopic]:
        counts: Counter[tuple[str, str]] = Counter()
        per_channel = summary.statistics.channel_message_counts if summary.statistics else {}
        for channel in summary.channels.values():
            schema = summary.schemas.get(channel.schema_id)
            self._take(channel, schema.name if schema else "")
            counts[self._channels[channel.id]] += per_channel.get(channel.id, 0)
        self._schemas |= {schema.id: schema.name for schema in summary.schemas.values()}
        self._index = [
            (chunk.message_start_time, chunk.chunk_start_offset) for chunk in summary.chunk_indexes
        ]
        return [BagTopic(*key, count) for key, count in counts.items()]

    def _scanned(self, stream: IO[bytes]) -> list[BagTopic]:
        """Index and count every message that can be read, and note the damage that ends it."""
        counts: Counter[tuple[str, str]] = Counter()
        times: list[int] = []
        try:
            for record in read_records(stream, len(MAGIC)):
                if record.opcode == Opcode.DATA_END:
                    break
                is_chunk = record.opcode == Opcode.CHUNK
                if is_chunk:
                    self._index.append((chunk_start_ns(record.content), record.offset))
                for inner in read_chunk(record.content) if is_chunk else iter([record]):
                    message = self._note(inner)
                    if message is None:
                        continue
                    if not is_chunk:
                        self._index.append((message.log_time_ns, record.offset))
                    counts[message.topic, message.message_type] += 1
                    times.append(message.log_time_ns)
        except McapDamage as damage:
            first, last = min(times, default=None), max(times, default=None)
            self.damage = damage_sentence(self._path.name, damage, first, last)
        return [BagTopic(*key, count) for key, count in counts.items()]


def _read_summary(stream: IO[bytes]) -> Summary | None:
    """Return the summary if it is there and whole: channels, counts and chunk index."""
    stream.seek(0)  # where SeekingReader expects the magic bytes
    try:
        summary = SeekingReader(stream).get_summary()
    except Exception:  # of a damaged file; no summary that can be read is no summary
        return None
    return summary if summary is not None and _is_whole(summary, stream) else None


def _is_whole(summary: Summary, stream: IO[bytes]) -> bool:
    """Whether a summary names every channel, schema and chunk, and counts every message."""
    statistics, channels = summary.statistics, summary.channels
    if statistics is None or not summary.chunk_indexes:
        return False
    counts = statistics.channel_message_counts
    schemas = {NO_SCHEMA, *summary.schemas}
    if (
        len(channels) != statistics.channel_count
        or len(summary.chunk_indexes) != statistics.chunk_count
        or sum(counts.values()) != statistics.message_count
        or not set(counts) <= set(channels)
        or not {channel.schema_id for channel in channels.values()} <= schemas
    ):
        return False
    after = {
        chunk.chunk_start_offset: chunk.chunk_start_offset
        + chunk.chunk_length
        + chunk.message_index_length
        for chunk in summary.chunk_indexes
    }
    try:
        return not has_loose_messages(stream, len(MAGIC), after)
    except McapDamage:
        return False
