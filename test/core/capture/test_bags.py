# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Real bag files: round trips, orders, compressions, and damage at every place."""

import numpy as np
import pytest
from rosbags.rosbag2 import CompressionMode, StoragePlugin, Writer

from reflest_core.capture.formats.topics import TopicChoice
from reflest_core.capture.messages import CompressedImageMessage, Role
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import CaptureError
from reflest_core.capture.settings import CaptureSettings
from test.core.capture.recording import (
    TOPICS,
    Recorded,
    changed,
    image,
    recording,
    stamp,
    write_bag,
)
from test.core.capture.test_assembler import assemble, counts

STORAGES = ("mcap", "sqlite3")


def same_frames(one, other):
    assert [frame.stamp_ns for frame in one] == [frame.stamp_ns for frame in other]
    for left, right in zip(one, other, strict=True):
        assert np.array_equal(left.rgb, right.rgb)
        assert np.array_equal(left.depth, right.depth)
        assert np.array_equal(left.T_world_camera, right.T_world_camera)
        assert left.intrinsics == right.intrinsics
        assert left.frame_id == right.frame_id


@pytest.mark.parametrize("storage", STORAGES)
def test_a_bag_gives_the_frames_of_its_messages(tmp_path, storage):
    file = write_bag(tmp_path / "bag", recording(6), storage)
    expected, _ = assemble(recording(6))
    for path in (tmp_path / "bag", file):
        capture = open_capture(path)
        same_frames(list(capture), expected)
        assert capture.frame_total == capture.frames_seen == 6
        assert capture.damage is None
        assert counts(capture.refusals) == {}


@pytest.mark.parametrize("storage", STORAGES)
def test_topics_written_one_after_the_other_are_read_by_time(tmp_path, storage):
    """A whole topic before the next: log time, not file order, decides."""
    messages = sorted(recording(40), key=lambda recorded: recorded.role.value)
    write_bag(tmp_path / "bag", messages, storage)
    capture = open_capture(tmp_path / "bag", settings=CaptureSettings(queue_size=4))
    assert len(list(capture)) == 40


def test_topics_logged_late_give_the_same_frames(tmp_path):
    delays = {Role.RGB: 0, Role.DEPTH: 90, Role.POSE: 200, Role.CAMERA_INFO: 31}
    write_bag(tmp_path / "a", recording(10))
    write_bag(tmp_path / "b", recording(10), log_offset=lambda role: delays[role] * 10**6)
    same_frames(list(open_capture(tmp_path / "a")), list(open_capture(tmp_path / "b")))


def test_odometry_and_compressed_images_are_read(tmp_path):
    import cv2

    messages = []
    for recorded in recording(3):
        message = recorded.message
        if recorded.role is Role.RGB:
            pixels = np.frombuffer(message.data, np.uint8).reshape(message.height, -1, 3)
            png = cv2.imencode(".png", pixels[:, :, ::-1])[1].tobytes()
            message = CompressedImageMessage(message.stamp_ns, message.frame_id, "png", png)
        messages.append(Recorded(recorded.role, message))
    child = "camera_color_optical_frame"
    for index in range(3):
        messages = changed(messages, Role.POSE, index, child_frame_id=child)
    write_bag(tmp_path / "bag", messages)
    expected, _ = assemble(recording(3))
    same_frames(list(open_capture(tmp_path / "bag")), expected)


def test_a_mask_topic_is_read_where_it_is_named(tmp_path):
    mask = np.zeros((72, 96), np.uint8)
    mask[20:40] = 1
    messages = [
        *recording(2),
        *[Recorded(Role.MASK, image(mask, "mono8", stamp(i))) for i in (0, 1)],
    ]
    write_bag(tmp_path / "bag", messages, topics={**TOPICS, Role.MASK: "/mask"})
    capture = open_capture(
        tmp_path / "bag", TopicChoice(mask="/mask"), CaptureSettings(use_mask=True)
    )
    frames = list(capture)
    assert len(frames) == 2
    assert np.array_equal(frames[0].mask, mask > 0)


def test_message_compression_is_unpacked(tmp_path):
    write_bag(tmp_path / "bag", recording(3), "sqlite3", compression=CompressionMode.MESSAGE)
    same_frames(list(open_capture(tmp_path / "bag")), assemble(recording(3))[0])


def test_file_compression_is_refused_with_the_way_out(tmp_path):
    write_bag(tmp_path / "bag", recording(2), "sqlite3", compression=CompressionMode.FILE)
    with pytest.raises(CaptureError, match="zstd -d"):
        open_capture(tmp_path / "bag")


def test_chunk_compression_is_unpacked(tmp_path):
    write_bag(tmp_path / "bag", recording(3), "mcap", compression=CompressionMode.STORAGE)
    same_frames(list(open_capture(tmp_path / "bag")), assemble(recording(3))[0])


CUTS = (0.05, 0.2, 0.5, 0.8, 0.95, 0.999)


@pytest.mark.parametrize("cut", CUTS)
@pytest.mark.parametrize("kind", ["mcap", "mcap zstd", "sqlite3"])
def test_a_cut_bag_gives_what_stands_before_the_cut(tmp_path, kind, cut):
    storage, _, is_packed = kind.partition(" ")
    compression = CompressionMode.STORAGE if is_packed else CompressionMode.NONE
    file = write_bag(tmp_path / "bag", recording(40), storage, compression=compression)
    whole = file.read_bytes()
    file.write_bytes(whole[: int(len(whole) * cut)])
    try:
        capture = open_capture(tmp_path / "bag")
        frames = list(capture)
    except CaptureError as error:
        assert cut <= 0.2, error
        assert file.name in str(error)
        return
    # sqlite and packed chunks do not lay messages out evenly: allow a tenth.
    assert len(frames) >= int(40 * (cut - 0.1 - 0.2 * bool(is_packed)))
    assert len(frames) <= 40
    same_frames(frames, assemble(recording(40))[0][: len(frames)])
    if cut < 0.99:
        assert f"{file.name} is damaged" in capture.damage
        assert "could be read" in capture.damage


@pytest.mark.parametrize("storage", STORAGES)
def test_no_cut_ever_crashes(tmp_path, storage):
    file = write_bag(tmp_path / "bag", recording(3), storage)
    whole = file.read_bytes()
    lengths = [*range(0, 200, 7), *range(200, len(whole), len(whole) // 60)]
    for length in lengths:
        file.write_bytes(whole[:length])
        try:
            assert len(list(open_capture(file))) <= 3
        except CaptureError as error:
            assert file.name in str(error)


@pytest.mark.parametrize("storage", STORAGES)
def test_no_garbage_in_the_middle_ever_crashes(tmp_path, storage):
    file = write_bag(tmp_path / "bag", recording(3), storage)
    whole = file.read_bytes()
    noise = np.random.default_rng(7)
    for _ in range(60):
        broken = bytearray(whole)
        start = int(noise.integers(0, len(whole)))
        length = min(int(noise.integers(1, 400)), len(whole) - start)
        broken[start : start + length] = noise.bytes(length)
        file.write_bytes(broken)
        try:
            assert len(list(open_capture(file))) <= 3
        except CaptureError as error:
            assert file.name in str(error)


def test_a_recorder_that_died_leaves_a_bag_without_metadata(tmp_path):
    write_bag(tmp_path / "bag", recording(4))
    (tmp_path / "bag/metadata.yaml").write_text("rosbag2_bagfile_information: [")
    capture = open_capture(tmp_path / "bag")
    assert len(list(capture)) == 4
    assert "metadata.yaml is missing or damaged" in capture.damage


@pytest.mark.parametrize(
    "text",
    ["a: 2020-99-99", "[" * 20000, "a: &a [*a, *a]", "\xff", "rosbag2_bagfile_information: 5"],
)
def test_metadata_of_any_kind_are_passed_over(tmp_path, text):
    write_bag(tmp_path / "bag", recording(2))
    (tmp_path / "bag/metadata.yaml").write_text(text)
    capture = open_capture(tmp_path / "bag")
    assert len(list(capture)) == 2
    assert "metadata.yaml is missing or damaged" in capture.damage


LAUGHS = "\n".join(
    ["a0: &a0 x", *(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 12))]
)


def test_metadata_whose_mode_unfolds_to_billions_are_passed_over(tmp_path):
    write_bag(tmp_path / "bag", recording(2))
    path = tmp_path / "bag/metadata.yaml"
    text = path.read_text().replace("compression_mode: ''", "compression_mode: *a11")
    assert "*a11" in text
    path.write_text(f"{LAUGHS}\n{text}")
    assert len(list(open_capture(tmp_path / "bag"))) == 2


def test_a_file_that_is_listed_twice_is_read_once(tmp_path):
    write_bag(tmp_path / "bag", recording(3))
    path = tmp_path / "bag/metadata.yaml"
    listed = '- bag.mcap\n  - bag.mcap\n  - "b\\0.mcap"'
    path.write_text(path.read_text().replace("- bag.mcap", listed, 1))
    capture = open_capture(tmp_path / "bag")
    assert len(list(capture)) == capture.frame_total == 3


def test_split_bags_are_read_in_number_order(tmp_path):
    """Files 2 and 10 of one recording: by name alone, 10 would come first."""
    messages = recording(8)
    (tmp_path / "bag").mkdir()
    for number, part in ((2, messages[:16]), (10, messages[16:])):
        file = write_bag(tmp_path / f"part{number}", part)
        file.rename(tmp_path / f"bag/bag_{number}.mcap")
    capture = open_capture(tmp_path / "bag")
    assert len(list(capture)) == 8
    assert counts(capture.refusals) == {}


def test_a_lost_part_of_a_split_bag_is_reported(tmp_path):
    write_bag(tmp_path / "bag", recording(4))
    listed = (tmp_path / "bag/metadata.yaml").read_text()
    listed = listed.replace("- bag.mcap", "- bag.mcap\n  - lost.mcap")
    (tmp_path / "bag/metadata.yaml").write_text(listed)
    capture = open_capture(tmp_path / "bag")
    assert len(list(capture)) == 4
    assert "lost.mcap" in capture.damage


@pytest.mark.parametrize("name", ["x.mcap", "x.db3"])
@pytest.mark.parametrize("content", [b"", b"not a bag at all" * 10])
def test_what_is_no_bag_ends_with_one_sentence(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(CaptureError, match=name):
        open_capture(tmp_path / name)


def test_an_empty_bag_says_so(tmp_path):
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP):
        pass
    with pytest.raises(CaptureError, match=r"no messages|before its first message"):
        open_capture(tmp_path / "bag")


def test_a_bag_takes_no_intrinsics(tmp_path):
    write_bag(tmp_path / "bag", recording(1))
    with pytest.raises(CaptureError, match="--intrinsics"):
        open_capture(tmp_path / "bag", pinhole=(1.0, 1.0, 1.0, 1.0))
