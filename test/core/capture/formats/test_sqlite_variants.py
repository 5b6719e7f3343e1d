# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""rosbag2's databases in WAL mode, read-only, message-compressed, or not what they claim to be."""

import shutil
import sqlite3

import pytest
from rosbags.rosbag2 import CompressionMode

from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import CaptureError
from test.core.capture.recording import recording, write_bag
from test.core.capture.test_assembler import assemble
from test.core.capture.test_bags import same_frames


@pytest.fixture
def database(tmp_path):
    return write_bag(tmp_path / "bag", recording(4), "sqlite3")


def test_a_database_in_wal_mode_is_read_and_nothing_is_left_beside_it(database):
    connection = sqlite3.connect(database)
    connection.execute("PRAGMA journal_mode=WAL")
    connection.execute("CREATE TABLE other(a)")
    connection.commit()
    connection.close()
    database.chmod(0o444)
    before = sorted(database.parent.iterdir())
    same_frames(list(open_capture(database)), assemble(recording(4))[0])
    assert sorted(database.parent.iterdir()) == before


def test_what_a_dead_recorder_left_in_the_log_is_read_and_left_there(database, tmp_path):
    """Half of the messages are in the -wal file alone."""
    connection = sqlite3.connect(database)
    connection.execute("PRAGMA journal_mode=WAL")
    rows = connection.execute("SELECT * FROM messages WHERE id > 8").fetchall()
    connection.execute("DELETE FROM messages WHERE id > 8")
    connection.commit()
    connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    connection.executemany("INSERT INTO messages VALUES (?, ?, ?, ?)", rows)
    connection.commit()
    (tmp_path / "died").mkdir()
    for suffix in ("", "-wal"):
        name = f"{database.name}{suffix}"
        shutil.copy(database.parent / name, tmp_path / "died" / name)
    connection.close()
    before = {path.name: path.read_bytes() for path in (tmp_path / "died").iterdir()}
    assert len(before) == 2
    frames = list(open_capture(tmp_path / "died" / database.name))
    same_frames(frames, assemble(recording(4))[0])
    assert {path.name: path.read_bytes() for path in (tmp_path / "died").iterdir()} == before


def test_compressed_messages_are_unpacked_without_the_metadata(tmp_path):
    file = write_bag(tmp_path / "bag", recording(3), "sqlite3", compression=CompressionMode.MESSAGE)
    same_frames(list(open_capture(file)), assemble(recording(3))[0])


ENDLESS = (
    "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS id, 1 AS topic_id,"
    " i AS timestamp, x'00' AS data FROM n"
)


@pytest.mark.parametrize(
    "statements",
    [
        ["DROP TABLE messages", f"CREATE VIEW messages AS {ENDLESS}"],
        ["DROP TABLE topics"],
        ["UPDATE topics SET name = x'ff00'"],
        ["UPDATE topics SET type = x'05'"],
        ["UPDATE messages SET data = 'text'"],
        ["UPDATE messages SET timestamp = 'soon'"],
        ["UPDATE messages SET topic_id = 99"],
        ["UPDATE messages SET timestamp = 1e300"],
    ],
)
def test_a_database_that_holds_something_else_ends_in_a_sentence(database, statements):
    connection = sqlite3.connect(database)
    for statement in statements:
        connection.execute(statement)
    connection.commit()
    connection.close()
    try:
        capture = open_capture(database)
        list(capture)
        assert capture.damage
    except CaptureError as error:
        assert database.name in str(error)
