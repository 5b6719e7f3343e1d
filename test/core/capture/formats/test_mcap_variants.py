# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Every valid MCAP file gives the messages that the reference reader gives."""

import io
import itertools

import pytest
import zstandard
from mcap.reader import NonSeekingReader
from mcap.writer import CompressionType, IndexType, Writer

from reflest_core.capture.formats import mcap_records
from reflest_core.capture.formats.mcap_file import McapFile
from reflest_core.capture.messages import Role
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import CaptureError
from test.core.capture.recording import STORE, TOPICS, _as_ros, recording
from test.core.capture.test_assembler import assemble
from test.core.capture.test_bags import same_frames

COUNT = 4


def write_mcap(path, encoding="cdr", ros1_names=False, between=None, at_end=None, **options):
    """Write the recording with the official writer; ``between`` adds records in the middle."""
    with path.open("wb") as stream:
        writer = Writer(stream, **options)
        writer.start("ros2", "test")
        channels = {}
        for index, recorded in enumerate(recording(COUNT)):
            message_type, message = _as_ros(recorded.message)
            topic = TOPICS[recorded.role]
            if topic not in channels:
                definition = STORE.generate_msgdef(message_type)[0].encode()
                name = message_type.replace("/msg/", "/") if ros1_names else message_type
                schema = writer.register_schema(name, "ros2msg", definition)
                channels[topic] = writer.register_channel(topic, encoding, schema)
            if between is not None and index % 5 == 2:
                between(writer, recorded.message.stamp_ns)
            data = bytes(STORE.serialize_cdr(message, message_type))
            stamp_ns = recorded.message.stamp_ns
            writer.add_message(channels[topic], stamp_ns, data, stamp_ns)
        if at_end is not None:
            at_end(writer)
        writer.finish()
    return path


def by_reference(path):
    """All messages of a file, by the mcap package's reader that needs no index."""
    reader = NonSeekingReader(io.BytesIO(path.read_bytes()))
    found = [
        (channel.topic, message.log_time, message.data)
        for _, channel, message in reader.iter_messages(log_time_order=False)
    ]
    return sorted(found)


def by_us(path):
    file = McapFile(path)
    topics = [topic.name for topic in file.topics]
    found = [(raw.topic, raw.log_time_ns, raw.cdr) for raw in file.messages(topics)]
    assert file.damage is None
    assert sum(topic.count for topic in file.topics) == len(found)
    assert [time for _, time, _ in found] == sorted(time for _, time, _ in found)
    return sorted(found)


def telemetry(writer, stamp_ns):
    """A message on a JSON channel without a schema."""
    channel = writer.register_channel("/telemetry", "json", 0)
    writer.add_message(channel, stamp_ns, b"{}", stamp_ns)


def attachment(writer, stamp_ns):
    writer.add_attachment(stamp_ns, stamp_ns, "notes.txt", "text/plain", b"x" * 500)
    writer.add_metadata("m", {"a": "b"})


def without_counts(writer):
    for name, value in vars(writer).items():
        if name.endswith("__statistics"):
            value.channel_message_counts.clear()


OPTIONS = [
    {"repeat_channels": False},
    {"repeat_schemas": False},
    {"use_statistics": False},
    {"use_summary_offsets": False},
    {"index_types": IndexType.NONE},
    {"index_types": IndexType.MESSAGE},
    {"use_chunking": False},
    {"chunk_size": 1},
    {"chunk_size": 2**24},
    {"enable_crcs": False},
    {"enable_data_crcs": True},
    {
        "repeat_channels": False,
        "repeat_schemas": False,
        "use_statistics": False,
        "use_summary_offsets": False,
        "index_types": IndexType.NONE,
    },
]
EXTRAS = {
    "nothing": {},
    "schemaless": {"between": telemetry},
    "attachments": {"between": attachment},
    "no counts": {"at_end": without_counts},
}


@pytest.mark.parametrize(
    ("options", "extra", "compression"),
    [
        *itertools.product(OPTIONS, EXTRAS, [CompressionType.ZSTD]),
        *itertools.product([{}], EXTRAS, CompressionType),
    ],
)
def test_any_valid_file_gives_the_reference_readers_messages(tmp_path, options, extra, compression):
    path = tmp_path / "a.mcap"
    write_mcap(path, compression=compression, **options, **EXTRAS[extra])
    assert by_us(path) == by_reference(path)
    same_frames(list(open_capture(path)), assemble(recording(COUNT))[0])


def test_messages_outside_of_chunks_are_read_beside_those_inside(tmp_path):
    inside, outside = tmp_path / "a.mcap", tmp_path / "b.mcap"
    write_mcap(inside)
    write_mcap(outside, use_chunking=False)
    # The data section of the second, in front of the first's DataEnd, under other channel ids.
    data, loose = inside.read_bytes(), outside.read_bytes()
    start = len(mcap_records.__name__) * 0 + 8
    records = list(records_of(loose, start))
    moved = b"".join(
        loose[record.offset : record.offset + 9 + len(record.content)]
        for record in records
        if record.opcode in (3, 4, 5)
    )
    first_chunk = next(record.offset for record in records_of(data, start) if record.opcode == 6)
    (tmp_path / "c.mcap").write_bytes(data[:first_chunk] + moved + data[first_chunk:])
    assert len(by_us_unindexed(tmp_path / "c.mcap")) == 2 * len(by_us(inside))


def records_of(data, offset):
    """The records up to DataEnd."""
    for record in mcap_records.read_records(io.BytesIO(data), offset):
        yield record
        if record.opcode == 15:
            return


def by_us_unindexed(path):
    file = McapFile(path)
    return list(file.messages([topic.name for topic in file.topics]))


@pytest.mark.parametrize("role", [Role.RGB, Role.DEPTH, Role.CAMERA_INFO, Role.POSE])
def test_another_type_on_a_topic_is_passed_over(tmp_path, role):
    def text(writer, stamp_ns):
        schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"string data")
        channel = writer.register_channel(TOPICS[role], "cdr", schema)
        writer.add_message(channel, stamp_ns, b"\0\1\0\0\2\0\0\0x\0", stamp_ns)

    path = write_mcap(tmp_path / "a.mcap", between=text)
    same_frames(list(open_capture(path)), assemble(recording(COUNT))[0])


def test_types_may_be_named_as_in_ros_1_while_messages_are_of_ros_2(tmp_path):
    path = write_mcap(tmp_path / "a.mcap", ros1_names=True)
    same_frames(list(open_capture(path)), assemble(recording(COUNT))[0])


def test_a_ros_1_recording_is_named(tmp_path):
    write_mcap(tmp_path / "a.mcap", encoding="ros1", ros1_names=True)
    with pytest.raises(CaptureError, match="ROS 1 recording"):
        open_capture(tmp_path / "a.mcap")


@pytest.mark.parametrize("name", ["a.mcap", "a.db3"])
def test_a_git_lfs_pointer_is_named(tmp_path, name):
    pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 5\n"
    (tmp_path / name).write_text(pointer)
    with pytest.raises(CaptureError, match="git lfs pull"):
        open_capture(tmp_path / name)


def chunk(compression, data, size):
    header = mcap_records.CHUNK_HEADER.pack(0, 0, size, 0, len(compression))
    return header + compression + len(data).to_bytes(8, "little") + data


@pytest.mark.parametrize(("compression", "claimed"), [(b"zstd", 100), (b"zstd", 2**40)])
def test_a_chunk_unpacks_to_no_more_than_it_claims_and_claims_are_bounded(compression, claimed):
    bomb = zstandard.ZstdCompressor().compress(bytes(10**7))
    with pytest.raises(mcap_records.McapDamage):
        list(mcap_records.read_chunk(chunk(compression, bomb, claimed)))


def test_records_that_claim_more_than_the_file_holds_end_the_reading():
    header = mcap_records.RECORD_HEADER.pack(5, 2**40)
    with pytest.raises(mcap_records.McapDamage, match="cut off"):
        list(mcap_records.read_records(io.BytesIO(header + bytes(100)), 0))
    with pytest.raises(mcap_records.McapDamage, match="cut off"):
        list(mcap_records.read_records(io.BytesIO(bytes(100)), 2**64 - 1))
