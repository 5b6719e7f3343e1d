"""MCAP files, whole or cut off.

With its index the file is read in log-time order, chunk by chunk. Without one (a recorder that
died) it is read from the front in file order, up to the damage.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path

from mcap.reader import SeekingReader
from mcap.records import Channel, DataEnd, Message, Schema
from mcap.stream_reader import StreamReader
from mcap.summary import Summary

from reflest_core.capture.bag_file import BagTopic, RawMessage, damage_sentence
from reflest_core.capture.errors import CaptureError

MAGIC = b"\x89MCAP0\r\n"


class McapFile:
    """One MCAP file; ``damage`` is a sentence where it could not be read to its end."""

    def __init__(self, path: Path) -> None:
        """Read the summary, or where there is none the whole file once.

        Raises:
            CaptureError: if it is not an MCAP file or holds no message that can be read.
        """
        self.damage: str | None = None
        self._path = path
        with path.open("rb") as stream:
            if stream.read(len(MAGIC)) != MAGIC:
                raise CaptureError(f"{path} is not an MCAP file (or is cut off at its very start)")
        self._summary = self._read_summary()
        self.topics = self._summarised(self._summary) if self._summary else self._scanned()

    def messages(self, topics: Collection[str]) -> Iterator[RawMessage]:
        """Yield the messages of ``topics`` up to the end or the damage."""
        records = self._by_index(topics) if self._summary else self._by_position(topics)
        first = last = None
        try:
            for record in records:
                first = record.log_time_ns if first is None else first
                last = record.log_time_ns
                yield record
        except Exception as error:  # a damaged file makes its parsers raise anything
            self.damage = damage_sentence(self._path.name, error, first, last)

    def _read_summary(self) -> Summary | None:
        """Return the summary if it is there and whole: channels, counts and chunk index."""
        with self._path.open("rb") as stream:
            try:
                summary = SeekingReader(stream).get_summary()
            except Exception:  # as above: no summary that can be read is no summary
                return None
        is_useful = summary is not None and summary.statistics and summary.chunk_indexes
        return summary if is_useful else None

    @staticmethod
    def _summarised(summary: Summary) -> list[BagTopic]:
        counts: Counter[tuple[str, str]] = Counter()
        for channel in summary.channels.values():
            schema = summary.schemas.get(channel.schema_id)
            key = (channel.topic, schema.name if schema else "")
            counts[key] += (
                summary.statistics.channel_message_counts.get(channel.id, 0)
                if summary.statistics
                else 0
            )
        return [BagTopic(*key, count) for key, count in counts.items()]

    def _scanned(self) -> list[BagTopic]:
        """Count every message that can be read, and note the damage that ends it."""
        counts: Counter[tuple[str, str]] = Counter()
        first = last = None
        try:
            for record in self._by_position(None):
                counts[record.topic, record.message_type] += 1
                first = record.log_time_ns if first is None else first
                last = record.log_time_ns
        except Exception as error:  # as above
            self.damage = damage_sentence(self._path.name, error, first, last)
        if not counts:
            raise CaptureError(self.damage or f"{self._path} holds no messages")
        return [BagTopic(*key, count) for key, count in counts.items()]

    def _by_index(self, topics: Collection[str]) -> Iterator[RawMessage]:
        with self._path.open("rb") as stream:
            reader = SeekingReader(stream, validate_crcs=True)
            for schema, channel, message in reader.iter_messages(topics=list(topics)):
                name = schema.name if schema else ""
                yield RawMessage(channel.topic, name, message.log_time, message.data)

    def _by_position(self, topics: Collection[str] | None) -> Iterator[RawMessage]:
        schemas: dict[int, Schema] = {}
        channels: dict[int, Channel] = {}
        with self._path.open("rb") as stream:
            for record in StreamReader(stream, validate_crcs=True).records:
                if isinstance(record, DataEnd):
                    return
                if isinstance(record, Schema):
                    schemas[record.id] = record
                elif isinstance(record, Channel):
                    channels[record.id] = record
                elif isinstance(record, Message):
                    channel = channels[record.channel_id]
                    if topics is None or channel.topic in topics:
                        schema = schemas.get(channel.schema_id)
                        name = schema.name if schema else ""
                        yield RawMessage(channel.topic, name, record.log_time, record.data)
