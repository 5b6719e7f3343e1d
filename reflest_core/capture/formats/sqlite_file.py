# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""rosbag2's sqlite3 files (.db3), whole or cut off; nothing is written beside them.

A file is opened as immutable, which needs no lock or shared memory and so reads a database in WAL
mode on a read-only disk. Where a recorder that died left messages in ``-wal``, both files are
copied to a temporary folder first.
"""

from __future__ import annotations

import shutil
import sqlite3
from collections import Counter
from collections.abc import Collection, Iterator
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory

from reflest_core.capture.formats.bag_file import (
    BagTopic,
    RawMessage,
    damage_sentence,
    pointer_sentence,
)
from reflest_core.capture.refusal import CaptureError


class SqliteFile:
    """One .db3 file; ``damage`` is a sentence where it could not be read to its end."""

    def __init__(self, path: Path) -> None:
        """Read which messages there are.

        Args:
            path: the file or folder.

        Raises:
            CaptureError: if it is not such a file or holds no message that can be read.
        """
        self.damage: str | None = None
        self._path = path
        self._topics: dict[int, tuple[str, str]] = {}
        self._index: list[tuple[int, int, int]] = []  # log time, message id, topic id
        self._database, self._copy = path, _copied(path)
        if self._copy is not None:
            self._database = Path(self._copy.name) / path.name
        try:
            with closing(self._connect()) as database:
                _check_tables(database)
                for topic_id, name, message_type in database.execute(
                    "SELECT id, name, type FROM topics"
                ):
                    if not isinstance(name, str) or not isinstance(message_type, str):
                        raise sqlite3.DatabaseError("its table of topics holds garbage")
                    self._topics[topic_id] = (name, message_type)
                self._read_index(database)
        except (sqlite3.Error, UnicodeDecodeError, OverflowError) as error:
            raise CaptureError(
                pointer_sentence(path) or f"{path} cannot be read as a rosbag2 database: {error}"
            ) from error
        if not self._index:
            raise CaptureError(self.damage or f"{path} holds no messages")

    @property
    def topics(self) -> list[BagTopic]:
        """All recorded topics."""
        counts = Counter(topic_id for _, _, topic_id in self._index)
        return [BagTopic(*self._topics[key], counts[key]) for key in self._topics]

    def messages(self, topics: Collection[str]) -> Iterator[RawMessage]:
        """Yield the messages of ``topics`` by log time, up to the end or the damage.

        Args:
            topics: names of the topics to read.
        """
        wanted = {key for key, (name, _) in self._topics.items() if name in topics}
        first = last = None
        with closing(self._connect()) as database:
            for log_time, message_id, topic_id in self._index:
                if topic_id not in wanted:
                    continue
                query = "SELECT data FROM messages WHERE id = ?"
                try:
                    row = database.execute(query, (message_id,)).fetchone()
                    if row is None or not isinstance(row[0], bytes):
                        raise sqlite3.DatabaseError("a message is not where its index says")
                except sqlite3.Error as error:
                    self.damage = damage_sentence(self._path.name, error, first, last)
                    return
                (cdr,) = row
                yield RawMessage(*self._topics[topic_id], log_time, cdr)
                first, last = log_time if first is None else first, log_time

    def _connect(self) -> sqlite3.Connection:
        uri = f"{self._database.absolute().as_uri()}?mode=ro"
        uri += "" if self._copy else "&immutable=1"
        database = sqlite3.connect(uri, uri=True)
        # SQLite reads a file that is shorter than its header says in this mode alone.
        database.execute("PRAGMA writable_schema = ON")
        return database

    def _read_index(self, database: sqlite3.Connection) -> None:
        # In the table's own order, so that damage ends the list and does not prevent it.
        rows = database.execute("SELECT timestamp, id, topic_id FROM messages ORDER BY id")
        try:
            for log_time, message_id, topic_id in rows:
                if not all(isinstance(value, int) for value in (log_time, message_id, topic_id)):
                    raise sqlite3.DatabaseError("its table of messages holds garbage")
                if topic_id in self._topics:
                    self._index.append((log_time, message_id, topic_id))
        except sqlite3.Error as error:
            times = [log_time for log_time, _, _ in self._index]
            first, last = min(times, default=None), max(times, default=None)
            self.damage = damage_sentence(self._path.name, error, first, last)
        self._index.sort()


def _copied(path: Path) -> TemporaryDirectory[str] | None:
    """Copy a database with its write-ahead log, where that holds messages; else return None."""
    log = path.with_name(f"{path.name}-wal")
    if not log.is_file() or log.stat().st_size == 0:
        return None
    folder = TemporaryDirectory(prefix="reflest-bag-")
    for file in (path, log):
        shutil.copyfile(file, Path(folder.name) / file.name)
    return folder


def _check_tables(database: sqlite3.Connection) -> None:
    """Refuse views in the place of the two tables: a recursive one never ends."""
    kinds = dict(
        database.execute("SELECT name, type FROM sqlite_master WHERE name IN ('topics','messages')")
    )
    if kinds != {"topics": "table", "messages": "table"}:
        raise sqlite3.DatabaseError("it has no tables named topics and messages")
