# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What every kind of bag file offers: its topics, its raw messages, and how far it can be read."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

LFS_POINTER = b"version https://git-lfs.github.com/spec/"


class RawMessage(NamedTuple):
    """One recorded message, still in CDR.

    Attributes:
        topic: Its topic.
        message_type: As ``sensor_msgs/msg/Image``.
        log_time_ns: When it was recorded.
        cdr: The serialised message.
    """

    topic: str
    message_type: str
    log_time_ns: int
    cdr: bytes


@dataclass(frozen=True)
class BagTopic:
    """A recorded topic.

    Attributes:
        name: Of the topic.
        message_type: As ``sensor_msgs/msg/Image``.
        count: Messages; None where the file does not say.
    """

    name: str
    message_type: str
    count: int | None


class BagFile(Protocol):
    """An open bag file. ``damage`` is a sentence once damage was met, else None."""

    damage: str | None

    @property
    def topics(self) -> list[BagTopic]:
        """All recorded topics."""
        ...

    def messages(self, topics: Collection[str]) -> Iterator[RawMessage]:
        """Yield the messages of some topics in recorded order, up to the end or the damage.

        Args:
            topics: names of the topics to read.
        """
        ...


def pointer_sentence(path: Path) -> str | None:
    """Say that a file is a Git LFS pointer, with the way out; None where it is none.

    Args:
        path: The file.

    Returns:
        The sentence, or None.
    """
    with path.open("rb") as stream:
        if not stream.read(len(LFS_POINTER)).startswith(LFS_POINTER):
            return None
    return f"{path} is a Git LFS pointer, the data were not fetched: run `git lfs pull` there"


def damage_sentence(name: str, why: object, first_ns: int | None, last_ns: int | None) -> str:
    """Say how far a damaged file could be read.

    Args:
        name: the file.
        why: what is missing.
        first_ns: stamp of the first message, nanoseconds; None if unknown.
        last_ns: stamp of the last message, nanoseconds; None if unknown.
    """
    reason = str(why) or type(why).__name__
    if first_ns is None or last_ns is None:
        return f"{name} is damaged ({reason}) before its first message"
    seconds = (last_ns - first_ns) / 1e9
    return f"{name} is damaged ({reason}): only its first {seconds:.2f} s could be read"
