# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""7-Scenes and TUM folders: frames as written, odd files refused, what is missing named."""

import json
import os
import re
from pathlib import Path

import cv2
import numpy as np
import pytest

from reflest_core.capture.formats.topics import TopicChoice
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import CaptureError
from reflest_core.capture.settings import CaptureSettings
from reflest_core.fusion.poses.check import PoseCheck
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.capture.folder_writers import (
    LOSSY,
    MATRIX,
    WRITERS,
    openloris_sensors,
    write_openloris,
    write_scannet,
)
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
        if kind in LOSSY:
            assert np.abs(frame.rgb.astype(int) - colour_of(index)).mean() < 8
        else:
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


@pytest.mark.parametrize(
    ("missing", "sentence"),
    [
        (["pose.txt"], "seq has no frame-*.pose.txt:"),
        (["depth.png"], "seq has no frame-*.depth.png (or .pgm):"),
        (["pose.txt", "depth.png"], "no frame-*.depth.png (or .pgm) and no frame-*.pose.txt:"),
    ],
)
def test_a_folder_without_depth_or_poses_is_refused_when_it_is_opened(scenes, missing, sentence):
    for ending in missing:
        for path in scenes.glob(f"*.{ending}"):
            path.unlink()
    with pytest.raises(CaptureError, match=re.escape(sentence)):
        open_capture(scenes)


@pytest.mark.parametrize("kind", sorted({*WRITERS} - {"tum", "openloris", "nerfstudio"}))
def test_depth_maps_that_are_all_gone_are_named(tmp_path, kind):
    """In formats that find them by their names."""
    WRITERS[kind](tmp_path / "folder", 2)
    for path in (tmp_path / "folder").rglob("*"):
        if path.is_file() and "depth" in f"{path.parent.name}/{path.name}":
            path.unlink()
    with pytest.raises(CaptureError, match=r"folder (has|holds) no .*depth"):
        open_capture(tmp_path / "folder")


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


def test_openloris_intrinsics_are_read_in_the_order_that_they_have(tmp_path):
    write_openloris(tmp_path, 2)
    (frame, _) = open_capture(tmp_path)
    assert frame.intrinsics.matrix.tolist() == MATRIX.tolist()
    for content in (openloris_sensors(("fx", "fy", "cx", "cy")), "", "d400_color_optical_frame:"):
        (tmp_path / "sensors.yaml").write_text(content)
        with pytest.raises(CaptureError, match=r"sensors\.yaml holds no intrinsics.*--intrinsics"):
            open_capture(tmp_path)


@pytest.mark.parametrize("is_unpacked", [False, True])
def test_a_record3d_archive_is_named(tmp_path, is_unpacked):
    path = tmp_path / "scan.r3d"
    if is_unpacked:
        (path / "rgbd").mkdir(parents=True)
        (path / "metadata").write_text("{}")
    else:
        path.write_bytes(b"PK\x03\x04")
    with pytest.raises(CaptureError, match=r"LZFSE.*export it from the app as EXR \+ RGB"):
        open_capture(path)


@pytest.mark.parametrize("name", ["rgb.txt", "depth.txt", "groundtruth.txt"])
def test_a_missing_or_bad_tum_list_is_named(tum, name):
    (tum / name).write_text("1.0\n")
    with pytest.raises(CaptureError, match=f"{name}, line 1"):
        open_capture(tum)
    (tum / name).unlink()
    with pytest.raises(CaptureError, match=f"has no {name}: the format needs rgb.txt"):
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
def test_what_is_no_capture_is_refused_with_what_would_be(tmp_path, name, words):
    (tmp_path / "empty").mkdir()
    (tmp_path / "notes.txt").write_text("hello")
    (tmp_path / "old.bag").write_bytes(b"#ROSBAG V2.0\n")
    with pytest.raises(CaptureError, match=words):
        open_capture(tmp_path / name)


@pytest.mark.parametrize("kind", [kind for kind in WRITERS if kind not in LOSSY])
def test_every_format_gives_the_same_depth_and_poses(tmp_path, kind):
    """Whole millimetres, up to the rounding of each format's unit and of its numbers."""
    WRITERS[kind](tmp_path / "folder", 3)
    write_scannet(tmp_path / "reference", 3)
    frames, expected = (list(open_capture(tmp_path / name)) for name in ("folder", "reference"))
    for frame, other in zip(frames, expected, strict=True):
        # TUM's writer rounds to its own unit alone, of 0.2 mm.
        tolerance = {"tum": 6e-4, "replica": 1e-4, "icl_nuim": 1e-6}.get(kind, 0.0)
        assert np.abs(frame.depth - other.depth).max() <= tolerance
        assert frame.intrinsics == other.intrinsics
        if kind != "tum":
            np.testing.assert_allclose(frame.T_world_camera, other.T_world_camera, atol=1e-12)


@pytest.mark.parametrize("kind", [kind for kind in WRITERS if kind != "record3d"])
def test_the_users_unit_wins_in_every_format_and_is_said(tmp_path, kind):
    WRITERS[kind](tmp_path / "folder", 2)
    usual, heard = open_capture(tmp_path / "folder"), []
    settings = CaptureSettings(depth_scale=0.002)
    capture = open_capture(tmp_path / "folder", settings=settings, on_warning=heard.append)
    assert capture.settings.depth_scale == 0.002
    assert len(heard) == 1
    assert "capture.depth_scale 0.002" in heard[0]
    ratio = 0.002 / usual.settings.depth_scale
    for ours, theirs in zip(capture, usual, strict=True):
        np.testing.assert_allclose(ours.depth, theirs.depth * ratio, rtol=1e-5)


@pytest.mark.parametrize("kind", WRITERS)
def test_byte_order_marks_and_windows_line_ends_change_nothing(tmp_path, kind):
    for name in ("plain", "windows"):
        WRITERS[kind](tmp_path / name, 2)
    for path in (tmp_path / "windows").rglob("*"):
        if path.suffix in (".txt", ".csv", ".json", ".freiburg"):
            path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r\n"))
    plain, windows = (list(open_capture(tmp_path / name)) for name in ("plain", "windows"))
    assert len(plain) == 2
    for one, other in zip(plain, windows, strict=True):
        assert np.array_equal(one.depth, other.depth)
        assert np.array_equal(one.T_world_camera, other.T_world_camera)
        assert one.intrinsics == other.intrinsics


@pytest.mark.parametrize("kind", WRITERS)
def test_no_damaged_text_file_ends_in_a_traceback(tmp_path, kind):
    WRITERS[kind](tmp_path / "folder", 2)
    texts = [
        path
        for path in sorted((tmp_path / "folder").rglob("*"))
        if path.suffix in (".txt", ".csv", ".json", ".freiburg")
    ]
    for path in texts:
        whole = path.read_bytes()
        for content in (
            b"",
            b"\xff\xfe",
            b"words and words",
            b"{}",
            b"[1]",
            whole[: len(whole) // 2],
        ):
            path.write_bytes(content)
            try:
                assert len(list(open_capture(tmp_path / "folder"))) <= 2
            except CaptureError as error:
                assert "\n" not in str(error)
        path.write_bytes(whole)


def test_a_folders_images_that_are_git_lfs_pointers_are_named(scenes):
    pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 5\n"
    (scenes / "frame-000000.color.png").write_text(pointer)
    with pytest.raises(CaptureError, match="git lfs pull"):
        open_capture(scenes)


def test_smaller_depth_of_the_same_view_is_registered(tmp_path):
    """As a phone's lidar gives it."""
    WRITERS["nerfstudio"](tmp_path / "folder", 2)
    for path in (tmp_path / "folder/depth").iterdir():
        depth = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        cv2.imwrite(str(path), depth[::2, ::2])
    frames = list(open_capture(tmp_path / "folder"))
    assert len(frames) == 2
    inner = np.abs(frames[0].depth - depth_of(0))[2:-2, 2:-2]
    assert np.median(inner) < 0.005


def test_a_nerfstudio_camera_may_be_a_fisheye_and_differ_from_frame_to_frame(tmp_path):
    WRITERS["nerfstudio"](tmp_path / "folder", 2)
    path = tmp_path / "folder/transforms.json"
    document = json.loads(path.read_text())
    document |= {"camera_model": "OPENCV_FISHEYE", "k1": 0.01}
    document["frames"][0]["fl_x"] = 90.0  # the last in order of names
    path.write_text(json.dumps(document))
    frames = list(open_capture(tmp_path / "folder"))
    assert [frame.intrinsics.fx for frame in frames] == [FOCAL, 90.0]
    assert not np.array_equal(frames[0].rgb, colour_of(0))
    document["camera_model"] = "EQUIRECTANGULAR"
    path.write_text(json.dumps(document))
    with pytest.raises(CaptureError, match="EQUIRECTANGULAR"):
        open_capture(tmp_path / "folder")


def test_a_nerfstudio_frame_without_a_camera_of_its_own_has_the_shared_one(tmp_path):
    WRITERS["nerfstudio"](tmp_path / "folder", 3)
    path = tmp_path / "folder/transforms.json"
    document = json.loads(path.read_text())
    document["frames"].sort(key=lambda frame: frame["file_path"])
    document["frames"][0]["fl_x"] = 90.0
    path.write_text(json.dumps(document))
    frames = list(open_capture(tmp_path / "folder"))
    assert [frame.intrinsics.fx for frame in frames] == [90.0, FOCAL, FOCAL]


def test_icl_nuims_own_camera_does_not_hide_a_damaged_calibration(tmp_path):
    WRITERS["icl_nuim"](tmp_path / "folder", 1)
    (tmp_path / "folder/camera-intrinsics.txt").write_text("500 0 320")
    with pytest.raises(CaptureError, match=r"camera-intrinsics\.txt does not hold"):
        open_capture(tmp_path / "folder")


@pytest.mark.parametrize(
    ("name", "least"), [("redkitchen", 100), ("shelf_label_fusion", 15), ("bin_apc", 15)]
)
def test_real_captures_are_read_whole(name, least):
    folder = Path(os.environ.get("REFLEST_RGBD", "")) / name
    if not os.environ.get("REFLEST_RGBD") or not folder.is_dir():
        pytest.skip("REFLEST_RGBD does not name the folder of real captures")
    capture = open_capture(folder)
    frames = list(capture)
    assert len(frames) >= least
    assert counts(capture.refusals) == {}
    assert all(0.2 < np.median(frame.depth[frame.depth > 0]) < 5.0 for frame in frames)
    if name != "redkitchen":
        assert all((frame.depth > 0).mean() > 0.35 for frame in frames), "gaps are filled"
    check, scan = PoseCheck(), Scan(FusionSettings(voxel_size=0.01), RegionSettings())
    for frame in frames[:15]:
        check.add(frame)
        scan.fuse(frame)
    assert check.report.agreement > 0.65
    assert check.report.problem == ""
    assert scan.voxel_count > 1000


NUMBER = re.compile(rb"-?\d+\.?\d*(?:e[+-]?\d+)?")
ODD = (b"nan", b"inf", b"-1e400", b"-1", b"0", b"9" * 30, b"1e308", b"x", b"", b"null", b"[]")


@pytest.mark.parametrize("kind", WRITERS)
def test_no_odd_number_in_a_text_file_ends_in_a_traceback(tmp_path, kind):
    WRITERS[kind](tmp_path / "folder", 2)
    noise = np.random.default_rng(5)
    texts = [
        path
        for path in sorted((tmp_path / "folder").rglob("*"))
        if path.suffix in (".txt", ".csv", ".json", ".freiburg")
    ]
    for path in texts:
        whole = path.read_bytes()
        numbers = list(NUMBER.finditer(whole))
        damaged = [b"[" * 30000]
        for _ in range(25):
            match = numbers[int(noise.integers(len(numbers)))]
            odd = ODD[int(noise.integers(len(ODD)))]
            damaged.append(whole[: match.start()] + odd + whole[match.end() :])
        for content in damaged:
            path.write_bytes(content)
            try:
                assert len(list(open_capture(tmp_path / "folder"))) <= 2
            except CaptureError as error:
                assert "\n" not in str(error)
        path.write_bytes(whole)


def test_a_pipe_in_the_place_of_a_file_does_not_hang(tmp_path):
    os.mkfifo(tmp_path / "a.mcap")
    with pytest.raises(CaptureError, match="pipe"):
        open_capture(tmp_path / "a.mcap")
    with pytest.raises(CaptureError, match="not a regular file"):
        open_capture(tmp_path)
    write_scannet(tmp_path / "scan", 3)
    (tmp_path / "scan/depth/1.png").unlink()
    os.mkfifo(tmp_path / "scan/depth/1.png")
    capture = open_capture(tmp_path / "scan")
    assert len(list(capture)) == 2
    assert counts(capture.refusals) == {"truncated": 1, "depth_missing": 1}
