# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Colours that do not lie on the depth they came with are found and named; right ones are not."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from reflest_core.capture.open_capture import open_capture
from reflest_core.fusion.poses.check import PoseCheck
from reflest_core.fusion.poses.edge_maps import EdgeMaps
from reflest_core.fusion.poses.registration import RegistrationCheck


@pytest.fixture(scope="module", params=["captures/glossy-red", "captures/table"])
def frames(request):
    return list(open_capture(request.param))


def report_of(frames):
    check = PoseCheck()
    for frame in frames:
        check.add(frame)
    return check.report


def late(frames, by):
    """Colours of so many frames before."""
    last = len(frames) - 1
    return [
        replace(frame, rgb=frames[min(max(index - by, 0), last)].rgb)
        for index, frame in enumerate(frames)
    ]


def changed(frames, change):
    return [replace(frame, rgb=np.ascontiguousarray(change(frame.rgb))) for frame in frames]


def shifted(right, down):
    def change(rgb):
        matrix = np.array([[1.0, 0.0, right], [0.0, 1.0, down]])
        size = rgb.shape[1], rgb.shape[0]
        return cv2.warpAffine(rgb, matrix, size, borderMode=cv2.BORDER_REPLICATE)

    return change


def zoomed(across, down):
    def change(rgb):
        height, width = rgb.shape[:2]
        matrix = np.array(
            [
                [across, 0.0, (1.0 - across) * (width - 1) / 2.0],
                [0.0, down, (1.0 - down) * (height - 1) / 2.0],
            ]
        )
        return cv2.warpAffine(rgb, matrix, (width, height))

    return change


def noisy(frames):
    """Noise of 8 grey levels and 0.3 % of the depth, and a coarse jpeg."""
    noise = np.random.default_rng(1)
    found = []
    for frame in frames:
        rgb = np.clip(frame.rgb + noise.normal(0.0, 8.0, frame.rgb.shape), 0, 255).astype(np.uint8)
        packed = cv2.imencode(".jpg", rgb, [cv2.IMWRITE_JPEG_QUALITY, 50])[1]
        depth = frame.depth * noise.normal(1.0, 0.003, frame.depth.shape)
        rgb = cv2.imdecode(packed, cv2.IMREAD_COLOR)
        found.append(replace(frame, rgb=rgb, depth=depth.astype(np.float32)))
    return found


@pytest.mark.parametrize(("by", "words"), [(1, "1 frame:"), (3, "3 frames:"), (5, "5 frames:")])
def test_colours_that_lag_behind_depth_are_named(frames, by, words):
    assert f"colours seem to lag behind depth by {words}" in report_of(late(frames, by)).problem


def test_colours_ahead_of_depth_are_named(frames):
    assert "colours seem to be ahead of depth by 2 frames" in report_of(late(frames, -2)).problem


def test_colours_in_reverse_order_are_named(frames):
    pairs = zip(frames, reversed(frames), strict=True)
    problem = report_of([replace(frame, rgb=other.rgb) for frame, other in pairs]).problem
    assert "reverse order" in problem


@pytest.mark.parametrize(
    ("words", "change"),
    [
        ("upside down", lambda rgb: rgb[::-1]),
        ("mirrored left to right", lambda rgb: rgb[:, ::-1]),
        ("turned by 180 degrees", lambda rgb: rgb[::-1, ::-1]),
    ],
)
def test_colour_images_turned_against_depth_are_named(frames, words, change):
    assert f"colour images seem to be {words}" in report_of(changed(frames, change)).problem


def test_depth_upside_down_is_not_laid_to_a_mirrored_world(frames):
    turned = [replace(frame, depth=np.ascontiguousarray(frame.depth[::-1])) for frame in frames]
    problem = report_of(turned).problem
    assert "it is the depth images that seem to be turned" in problem
    assert "mirrored along" not in problem


@pytest.mark.parametrize(
    ("right", "down", "words"),
    [
        (10, 0, "about +10 pixels across and +0 down"),
        (-8, 6, "about -8 pixels across and +6 down"),
    ],
)
def test_a_shift_of_colours_against_depth_is_measured(frames, right, down, words):
    assert words in report_of(changed(frames, shifted(right, down))).problem


@pytest.mark.parametrize(
    ("across", "down", "words"),
    [
        (4 / 3, 4 / 3, "1.33 times as wide and 1.33 times as high"),
        (0.75, 1.0, "0.75 times as wide and 1.00 times as high"),
        (1.1, 1.1, "1.11 times as wide and 1.11 times as high"),
    ],
)
def test_colours_of_another_field_of_view_are_measured(frames, across, down, words):
    report = report_of(changed(frames, zoomed(across, down)))
    assert words in report.problem


@pytest.mark.parametrize("stride", [1, 2, 3])
@pytest.mark.parametrize("length", [10, 20, 60])
@pytest.mark.parametrize("spoil", [list, noisy])
def test_parts_of_right_captures_raise_nothing(frames, stride, length, spoil):
    report = report_of(spoil(frames[::stride][:length]))
    assert report.edge_agreement > 0.15
    assert report.problem == ""
    assert report.warning == ""


def test_a_single_late_frame_is_no_lag(frames):
    frames = list(frames)
    frames[20] = replace(frames[20], rgb=frames[17].rgb)
    assert report_of(frames).problem == ""


def test_a_camera_that_stands_still_says_nothing_of_a_lag(frames):
    noise = np.random.default_rng(2)
    still = [
        replace(
            frames[0],
            stamp_ns=frame.stamp_ns,
            rgb=np.clip(frames[0].rgb + noise.normal(0.0, 3.0, frames[0].rgb.shape), 0, 255).astype(
                np.uint8
            ),
        )
        for frame in frames
    ]
    assert report_of(still).problem == ""


def test_a_lag_that_begins_in_a_long_scan_is_found_in_the_next_burst(monkeypatch):
    monkeypatch.setattr("reflest_core.fusion.poses.registration.EVERY", 30)
    monkeypatch.setattr("reflest_core.fusion.poses.registration.BURST", 20)
    frames = list(open_capture("captures/glossy-red"))
    check = RegistrationCheck()
    for frame in frames[:30]:
        check.add(frame)
    check.judge()
    assert check.problem == ""
    for frame in late(frames, 3)[30:]:
        check.add(frame)
    check.judge()
    assert "lag behind depth by 3 frames" in check.problem


def test_a_poor_fit_gives_a_warning_with_its_measure_and_no_problem(monkeypatch):
    monkeypatch.setattr("reflest_core.fusion.poses.registration.SURE_FIT", 0.9)
    frames = changed(list(open_capture("captures/table")), shifted(10, 0))
    report = report_of(frames)
    assert report.problem == ""
    assert "about +10 pixels across" in report.warning
    assert report.to_json()["warning"] == report.warning


@pytest.mark.parametrize("shape", [(4, 4), (1, 1), (3, 200), (481, 641), (24, 24)])
def test_images_of_any_size_give_maps_or_none(frames, shape):
    frame = replace(
        frames[0], rgb=np.full((*shape, 3), 9, np.uint8), depth=np.ones(shape, np.float32)
    )
    maps = EdgeMaps.of(frame)
    assert maps is None or (np.isfinite(maps.colour).all() and not maps.is_known)
