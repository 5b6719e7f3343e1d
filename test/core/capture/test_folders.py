# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""7-Scenes and TUM folders: frames as written, odd files refused, what is missing named."""

import os
from pathlib import Path

import numpy as np
import pytest

from reflest_core.capture.formats.topics import TopicChoice
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import CaptureError
from test.core.capture.recording import (
    FOCAL,
    HEIGHT,
    WIDTH,
    camera_pose,
    colour_of,
    depth_of,
    write_seven_scenes,
    write_tum,
)
from test.core.capture.test_assembler import counts

WRITERS = {"seven_scenes": write_seven_scenes, "tum": write_tum}


@pytest.fixture
def scenes(tmp_path):
    write_seven_scenes(tmp_path / "seq")
    return tmp_path / "seq"


@pytest.fixture
def tum(tmp_path):
    write_tum(tmp_path / "tum")
    return tmp_path / "tum"


@pytest.mark.parametrize("kind", WRITERS)
def test_a_folder_gives_the_frames_that_were_written(tmp_path, kind):
    WRITERS[kind](tmp_path / "folder", 5)
    capture = open_capture(tmp_path / "folder")
    frames = list(capture)
    assert counts(capture.refusals) == {}
    assert len(frames) == capture.frame_total == 5
    for index, frame in enumerate(frames):
        assert np.array_equal(frame.rgb, colour_of(index))
        assert np.abs(frame.depth - depth_of(index)).max() < 0.001
        # TUM's poses come at 100 Hz, so that its frames' are interpolated.
        assert np.allclose(frame.T_world_camera, camera_pose(index), atol=1e-4)
        assert frame.intrinsics.fx == FOCAL
    assert frames[3].stamp_ns - frames[0].stamp_ns == pytest.approx(10**8, abs=1000)


def test_65535_is_unknown_depth(scenes):
    frame = next(iter(open_capture(scenes)))
    assert np.array_equal(frame.depth == 0, depth_of(0) == 0)


def test_a_frame_without_pose_or_depth_is_refused_and_the_rest_stays(scenes):
    (scenes / "frame-000001.depth.png").unlink()
    (scenes / "frame-000003.pose.txt").write_text("lost\n")
    (scenes / "frame-000004.color.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    capture = open_capture(scenes)
    assert [frame.stamp_ns for frame in capture] == [0, 66666666, 166666666]
    assert counts(capture.refusals) == {"depth_missing": 1, "pose_invalid": 1, "encoding": 1}


def test_a_nan_pose_is_refused(scenes):
    np.savetxt(scenes / "frame-000002.pose.txt", np.full((4, 4), np.nan))
    capture = open_capture(scenes)
    assert len(list(capture)) == 5
    assert counts(capture.refusals) == {"pose_invalid": 1}


def test_intrinsics_are_taken_from_the_parent_or_from_the_option(scenes):
    (scenes / "camera-intrinsics.txt").rename(scenes.parent / "camera-intrinsics.txt")
    assert next(iter(open_capture(scenes))).intrinsics.fx == FOCAL
    (scenes.parent / "camera-intrinsics.txt").unlink()
    with pytest.raises(CaptureError, match="--intrinsics"):
        open_capture(scenes)
    given = (90.0, 91.0, WIDTH / 2, HEIGHT / 2)
    intrinsics = next(iter(open_capture(scenes, pinhole=given))).intrinsics
    assert (intrinsics.fx, intrinsics.fy, intrinsics.cx, intrinsics.cy) == given


@pytest.mark.parametrize("content", ["", "1 2 3", "words"])
@pytest.mark.filterwarnings("ignore:loadtxt. input contained no data")
def test_a_bad_intrinsics_file_is_named(scenes, content):
    (scenes / "camera-intrinsics.txt").write_text(content)
    with pytest.raises(CaptureError, match=r"camera-intrinsics.txt does not hold a 3 x 3"):
        open_capture(scenes)


@pytest.mark.parametrize("name", ["rgb.txt", "depth.txt", "groundtruth.txt"])
def test_a_missing_or_bad_tum_list_is_named(tum, name):
    (tum / name).write_text("1.0\n")
    with pytest.raises(CaptureError, match=f"{name}, line 1"):
        open_capture(tum)
    (tum / name).unlink()
    with pytest.raises(CaptureError, match=f"{name} cannot be read"):
        open_capture(tum)


def test_a_listed_image_that_is_gone_costs_its_frame(tum):
    (tum / "depth/2.png").unlink()
    capture = open_capture(tum)
    assert len(list(capture)) == 5
    assert counts(capture.refusals) == {"truncated": 1, "depth_missing": 1}


def test_topics_do_not_apply_to_folders(scenes):
    with pytest.raises(CaptureError, match="no topics"):
        open_capture(scenes, TopicChoice(rgb="/camera"))


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("absent", "does not exist"),
        ("empty", "not a capture"),
        ("notes.txt", "not a capture"),
        ("old.bag", "rosbags-convert"),
    ],
)
def test_what_is_no_capture_is_told_what_would_be(tmp_path, name, words):
    (tmp_path / "empty").mkdir()
    (tmp_path / "notes.txt").write_text("hello")
    (tmp_path / "old.bag").write_bytes(b"#ROSBAG V2.0\n")
    with pytest.raises(CaptureError, match=words):
        open_capture(tmp_path / name)


def test_redkitchen_is_read_whole():
    folder = os.environ.get("REFLEST_REDKITCHEN")
    if not folder or not Path(folder).is_dir():
        pytest.skip("REFLEST_REDKITCHEN does not name the 7-Scenes red kitchen folder")
    capture = open_capture(folder)
    frames = list(capture)
    assert len(frames) == len(list(Path(folder).glob("*.pose.txt")))
    assert counts(capture.refusals) == {}
    assert all(0.3 < np.median(frame.depth[frame.depth > 0]) < 5.0 for frame in frames)
