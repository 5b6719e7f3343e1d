# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A recording as one stream of messages: an MCAP file, a .db3 file, or a rosbag2 directory."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from pathlib import Path

import yaml
import zstandard

from reflest_core.capture.formats.bag_file import BagFile, BagTopic, RawMessage
from reflest_core.capture.formats.cdr import READERS, read_message
from reflest_core.capture.formats.mcap_file import McapFile
from reflest_core.capture.formats.recorded_topics import CandidateTopic
from reflest_core.capture.formats.sqlite_file import SqliteFile
from reflest_core.capture.formats.topics import TopicChoice, choose_topics
from reflest_core.capture.images.compressed_header import read_header
from reflest_core.capture.messages import CompressedImageMessage, Role, SensorMessage
from reflest_core.capture.refusal import CaptureError, FrameRefused, RefusalCause

READERS_BY_SUFFIX: dict[str, Callable[[Path], BagFile]] = {".mcap": McapFile, ".db3": SqliteFile}


ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
LONGEST_METADATA = 2**24
UNREADABLE = (ValueError, KeyError, TypeError, AttributeError, RecursionError)
LARGEST_MESSAGE = 2**28  # bytes unpacked; what is longer is cut off there, and refused


class Bag:
    """Messages of a recording, in log order. ``name`` is the path as given."""

    depth_scale: float | None = None
    depth_encoding: str | None = None

    def __init__(self, path: Path, choice: TopicChoice, pose_source: str) -> None:
        """Open the files and choose which topic plays which role.

        Args:
            path: An MCAP or .db3 file, or a rosbag2 directory.
            choice: Topics that the user named.
            pose_source: ``pose``, ``odom`` or ``tf``.

        Raises:
            CaptureError: Nothing can be read, or the topics are missing or ambiguous.
        """
        self.name = str(path)
        self._notes: list[str] = []
        paths = self._listed(path) if path.is_dir() else [path]
        self._files = self._opened(paths)
        try:
            self.topics = choose_topics(self._candidates(), choice, self.name, pose_source)
        except CaptureError as error:
            raise CaptureError(f"{error}; {self.damage}" if self.damage else str(error)) from error
        counts = [
            topic.count for topic in self._all_topics() if topic.name == self.topics[Role.RGB]
        ]
        self.rgb_total = None if None in counts else sum(count or 0 for count in counts)

    @property
    def damage(self) -> str | None:
        """A sentence on what could not be read, as far as is known by now; else None."""
        notes = [*self._notes, *(file.damage for file in self._files if file.damage)]
        return "; ".join(notes) or None

    def messages(
        self, refuse: Callable[[FrameRefused], None]
    ) -> Iterator[tuple[Role, SensorMessage]]:
        """Yield every message of the chosen topics; undecodable ones go to ``refuse``.

        Args:
            refuse: called with each message that cannot be used.
        """
        roles = {name: role for role, name in self.topics.items()}
        for raw in self._raw_messages(roles):
            if raw.message_type not in READERS:
                continue
            try:
                yield roles[raw.topic], self._read(raw)
            except FrameRefused as refusal:
                refuse(refusal)

    def _read(self, raw: RawMessage) -> SensorMessage:
        cdr = raw.cdr
        # No CDR begins so: the message is compressed, whatever metadata.yaml says.
        if cdr.startswith(ZSTD_MAGIC):
            try:
                reader = zstandard.ZstdDecompressor().stream_reader(cdr)
                cdr = reader.read(LARGEST_MESSAGE)
            except zstandard.ZstdError as error:
                raise FrameRefused(
                    RefusalCause.TRUNCATED, f"a message on {raw.topic} cannot be unpacked: {error}"
                ) from error
        return read_message(raw.message_type, cdr, raw.topic)

    def _raw_messages(self, topics: Collection[str]) -> Iterator[RawMessage]:
        for file in self._files:
            yield from file.messages(topics)

    def _all_topics(self) -> list[BagTopic]:
        return [topic for file in self._files for topic in file.topics]

    def _candidates(self) -> list[CandidateTopic]:
        """Every topic once, image topics with the encoding of their first message.

        Where a topic's channels have several types, it has the first that is read.
        """
        types: dict[str, str] = {}
        for topic in self._all_topics():
            if types.get(topic.name) not in READERS:
                types[topic.name] = topic.message_type
        return [
            CandidateTopic(name, kind, self._encoding(name, kind)) for name, kind in types.items()
        ]

    def _encoding(self, topic: str, message_type: str) -> str:
        if not message_type.endswith("Image") or message_type not in READERS:
            return ""
        for raw in self._raw_messages([topic]):
            try:
                message = self._read(raw)
            except FrameRefused:
                continue
            if isinstance(message, CompressedImageMessage):
                return _packed_encoding(message)
            return str(getattr(message, "encoding", ""))
        return ""

    def _opened(self, paths: list[Path]) -> list[BagFile]:
        files, errors = [], []
        for path in paths:
            if path.exists() and not path.is_file():
                errors.append(f"{path} is not a regular file")
                continue
            try:
                files.append(READERS_BY_SUFFIX[path.suffix](path))
            except CaptureError as error:
                errors.append(str(error))
            except OSError as error:
                errors.append(f"{path} cannot be read: {error.strerror}")
        if not files:
            raise CaptureError("; ".join(errors))
        self._notes += errors
        return files

    def _listed(self, folder: Path) -> list[Path]:
        """Return the directory's files in recorded order, by metadata.yaml or by their names."""
        try:
            with (folder / "metadata.yaml").open(encoding="utf-8-sig") as stream:
                metadata = yaml.safe_load(stream.read(LONGEST_METADATA))
            information = metadata["rosbag2_bagfile_information"]
            listed = [Path(name).name for name in information["relative_file_paths"]]
            names = [name for name in dict.fromkeys(listed) if "\0" not in name]
            mode = information.get("compression_mode") or ""
            if not isinstance(mode, str):
                raise TypeError("compression_mode is no text")
        except (OSError, yaml.YAMLError, *UNREADABLE):
            self._notes.append(f"{folder}/metadata.yaml is missing or damaged, files go by name")
            names, mode = sorted((path.name for path in folder.iterdir()), key=_by_number), ""
        if mode.lower() == "file" or any(name.endswith(".zstd") for name in names):
            raise CaptureError(
                f"{folder} is compressed file by file: unpack it with `zstd -d --rm "
                f"{folder}/*.zstd` and delete its metadata.yaml"
            )
        paths = [folder / name for name in names if Path(name).suffix in READERS_BY_SUFFIX]
        if not paths:
            raise CaptureError(f"{folder} holds neither .mcap nor .db3 files")
        return paths


def _packed_encoding(message: CompressedImageMessage) -> str:
    """Return an image's format; a 16-bit png that does not name its encoding is depth's."""
    names_it = message.format.startswith(("16UC1", "mono16", "32FC1"))
    header = read_header(bytes(message.data)) if not names_it else None
    if header is not None and header.bit_depth == 16 and header.channels == 1:
        return f"16UC1; {message.format}"
    return message.format or (header.kind if header else "")


def _by_number(name: str) -> list[tuple[bool, int, str]]:
    """Sort key that puts bag_2 before bag_10."""
    parts = re.split(r"(\d+)", name)
    return [(part.isdigit(), int(part) if part.isdigit() else 0, part) for part in parts]
