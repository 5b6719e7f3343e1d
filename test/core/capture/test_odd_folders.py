# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Folders with clock times for numbers, or with numbers and fields that no file should hold."""

import re

import numpy as np
import pytest

from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import CaptureError
from test.core.capture.folder_writers import (
    write_apc,
    write_icl_nuim,
    write_record3d,
    write_stray_scanner,
)
from test.core.capture.recording import write_seven_scenes, write_tum


def renumber(folder, number_of):
    """Give the frames other numbers, in file names and in the lists of poses that name them."""
    for path in sorted(folder.rglob("*")):
        if match := re.fullmatch(r"(\D*)(\d+)(\..*)", path.name):
            path.rename(path.with_name(f"{match[1]}{number_of(int(match[2]))}{match[3]}"))
    for path in folder.glob("*.gt.freiburg"):
        path.write_text(
            re.sub(r"(?m)^(\d+)\.0", lambda m: str(number_of(int(m[1]))), path.read_text())
        )
    for path in folder.glob("cam.info.txt"):
        text = path.read_text()
        path.write_text(re.sub(r"(?<=frame-)\d+", lambda m: str(number_of(int(m[0]))), text))


@pytest.mark.parametrize("write", [write_seven_scenes, write_apc, write_icl_nuim])
@pytest.mark.parametrize("first", [1_750_000_000_000_000_000, 10**40])
def test_frames_numbered_by_a_clock_are_stamped_by_their_order(tmp_path, write, first):
    write(tmp_path / "a", 3)
    write(tmp_path / "b", 3)
    renumber(tmp_path / "b", lambda index: first + 33_333_333 * index)
    counted, clocked = (list(open_capture(tmp_path / name)) for name in "ab")
    assert [frame.stamp_ns for frame in clocked] == [0, 33_333_333, 66_666_666]
    for one, other in zip(counted, clocked, strict=True):
        assert np.array_equal(one.T_world_camera, other.T_world_camera)
        assert np.array_equal(one.depth, other.depth)


def test_a_record3d_image_with_a_huge_number_does_not_stop_the_rest(tmp_path):
    write_record3d(tmp_path / "folder", 3)
    (extra,) = (path for path in tmp_path.rglob("2.*") if path.parent.name == "rgb")
    extra.rename(extra.with_stem("9" * 40))
    assert len(list(open_capture(tmp_path / "folder"))) == 2


@pytest.mark.parametrize("word", ["1e9999999", "1e999980", "nan", "-1", "inf", "digits"])
def test_a_tum_stamp_that_is_no_time_is_named(tmp_path, word):
    write_tum(tmp_path / "folder", 2)
    with (tmp_path / "folder" / "rgb.txt").open("a") as file:
        file.write(f"{'9' * 1_000_000 if word == 'digits' else word} rgb/0.png\n")
    with pytest.raises(CaptureError, match=r"rgb\.txt, line \d+: expected a stamp"):
        open_capture(tmp_path / "folder")


@pytest.mark.parametrize(
    "text", ["9" * 200_000 + "\n", '"' + "0, 1, 2\n" * 40_000], ids=["long", "unclosed quote"]
)
def test_a_csv_field_without_an_end_is_named(tmp_path, text):
    write_stray_scanner(tmp_path / "folder", 2)
    with (tmp_path / "folder" / "odometry.csv").open("a") as file:
        file.write(text)
    with pytest.raises(CaptureError, match=r"odometry\.csv, line \d+: expected timestamp"):
        open_capture(tmp_path / "folder")


def test_a_pose_of_three_rows_is_named(tmp_path):
    write_apc(tmp_path / "folder", 2)
    path = tmp_path / "folder" / "cam.info.txt"
    head, title, _ = path.read_text().partition("# Camera-to-world")
    path.write_text(f"{head}{title} extrinsics for frame-000000\n1 0 0\n0 1 0\n0 0 1\n\n")
    with pytest.raises(CaptureError, match="frame-000000' is no 4 x 4 matrix"):
        open_capture(tmp_path / "folder")
