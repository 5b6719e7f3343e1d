# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The same frames in every format, encoding and transport give the same estimate."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from rosbags.rosbag2 import CompressionMode

from reflest_core.capture.messages import CompressedImageMessage, Role
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.settings import CaptureSettings
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.fusion.settings import FusionSettings
from test.core.capture.folder_writers import LOSSY, WRITERS
from test.core.capture.recording import (
    HEIGHT,
    TOPICS,
    WIDTH,
    Recorded,
    image,
    info_message,
    recording,
    write_bag,
)
from test.core.weight_files import untrained

COUNT = 12


@pytest.fixture(scope="module")
def estimate_of(tmp_path_factory):
    """What an untrained lightnet estimates from a capture, and how often depth maps were gaps."""
    weights = str(untrained("lightnet", tmp_path_factory.mktemp("weights")))

    def estimate(path, **capture):
        settings = ReflestSettings(
            capture=CaptureSettings(**capture),
            fusion=FusionSettings(voxel_size=0.01, memory_budget_mb=32.0),
            estimation=EstimationSettings(weights=weights),
        )
        opened = open_capture(path, settings=settings.capture)
        pipeline = Pipeline(settings)
        for frame in opened:
            pipeline.fuse(frame)
        assert not opened.refusals.counts
        snapshot = pipeline.snapshot()
        found = pipeline.estimate(snapshot)
        numbers = [*found.rho_d, found.rho_s, found.alpha, *found.rho_d_stddev]
        return numbers, snapshot.voxel_count, snapshot.observation_count

    return estimate


def of_role(role, change):
    """The recording with the messages of a role changed."""
    return [
        Recorded(one.role, change(one.message)) if one.role is role else one
        for one in recording(COUNT)
    ]


def pixels_of(message, channels=3):
    shape = (message.height, message.width, channels)[: 2 + (channels > 1)]
    return np.frombuffer(message.data, np.uint8 if channels > 1 else "<u2").reshape(shape)


def packed(suffix, format_name, channels=3):
    def change(message):
        pixels = pixels_of(message, channels)
        shown = pixels[:, :, ::-1] if channels == 3 else pixels
        data = cv2.imencode(suffix, shown)[1].tobytes() + bytes(100)
        return CompressedImageMessage(message.stamp_ns, message.frame_id, format_name, data)

    return change


def recoloured(encoding, conversion):
    def change(message):
        pixels = cv2.cvtColor(pixels_of(message), conversion)
        return image(pixels, encoding, message.stamp_ns)

    return change


def metres(message):
    return image((pixels_of(message, 1) * 0.001).astype("<f4"), "32FC1", message.stamp_ns)


def big_endian(message):
    swapped = pixels_of(message, 1).astype(">u2")
    return replace(message, data=swapped.tobytes(), is_bigendian=True)


def rotated(message):
    tenths = pixels_of(message, 1).astype(np.uint16) * 10
    stored = (tenths << 3) | (tenths >> 13)
    return replace(message, data=stored.astype("<u2").tobytes())


def slashed(message):
    return replace(message, frame_id=f"/{message.frame_id}")


def calibrated(**fields):
    def change(message):
        return replace(message, **fields)

    return change


BAGS = {
    "bgr8": (Role.RGB, recoloured("bgr8", cv2.COLOR_RGB2BGR), {}),
    "rgba8": (Role.RGB, recoloured("rgba8", cv2.COLOR_RGB2RGBA), {}),
    "colour as png": (Role.RGB, packed(".png", "rgb8; png compressed bgr8"), {}),
    "depth in metres": (Role.DEPTH, metres, {}),
    "depth of big endian": (Role.DEPTH, big_endian, {}),
    "depth as png": (Role.DEPTH, packed(".png", "16UC1; png compressed ", 1), {}),
    "depth as png without its encoding": (Role.DEPTH, packed(".png", "png", 1), {}),
    "depth with rotated bits": (Role.DEPTH, rotated, {"depth_encoding": "rotated"}),
    "slashes": (Role.CAMERA_INFO, slashed, {}),
    "no distortion by 14 zeros": (
        Role.CAMERA_INFO,
        calibrated(d=(0.0,) * 14, distortion_model="rational_polynomial"),
        {},
    ),
    "P of rectified images": (
        Role.CAMERA_INFO,
        calibrated(
            k=(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
            d=(0.1,) * 5,
            distortion_model="plumb_bob",
            p=(*info_message(0).k[:3], 0.0, *info_message(0).k[3:6], 0.0, 0.0, 0.0, 1.0, 0.0),
        ),
        {"rectified": True},
    ),
}


@pytest.fixture(scope="module")
def expected(estimate_of, tmp_path_factory):
    folder = tmp_path_factory.mktemp("plain") / "bag"
    write_bag(folder, recording(COUNT))
    return estimate_of(folder)


@pytest.mark.parametrize("name", BAGS)
def test_encodings_and_calibrations_give_the_same_bits(estimate_of, expected, tmp_path, name):
    role, change, settings = BAGS[name]
    write_bag(tmp_path / "bag", of_role(role, change))
    assert estimate_of(tmp_path / "bag", **settings) == expected


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
@pytest.mark.parametrize("mode", [CompressionMode.NONE, CompressionMode.MESSAGE])
def test_containers_give_the_same_bits(estimate_of, expected, tmp_path, storage, mode):
    write_bag(tmp_path / "bag", recording(COUNT), storage, compression=mode)
    assert estimate_of(tmp_path / "bag") == expected


@pytest.mark.parametrize("name", [name for name in WRITERS if name not in (*LOSSY, "tum")])
def test_folders_give_the_same_estimate(estimate_of, expected, tmp_path, name):
    """Poses are matrices here and quaternions there; Replica rounds depth to a unit of 0.15 mm."""
    WRITERS[name](tmp_path / "folder", COUNT)
    numbers, voxels, _ = estimate_of(tmp_path / "folder")
    if name == "replica":
        a_fifth_of_its_deviation = 0.2 * expected[0][-1]
        np.testing.assert_allclose(numbers, expected[0], atol=a_fifth_of_its_deviation)
    else:
        np.testing.assert_allclose(numbers, expected[0], rtol=1e-3)
    assert voxels == pytest.approx(expected[1], rel=0.01)


def test_depth_of_half_the_size_gives_nearly_the_same(estimate_of, expected, tmp_path):
    def halved(message):
        return image(
            np.ascontiguousarray(pixels_of(message, 1)[::2, ::2]), "16UC1", message.stamp_ns
        )

    half = (50.0, 0.0, WIDTH / 4, 0.0, 50.0, HEIGHT / 4, 0.0, 0.0, 1.0)
    infos = [
        Recorded(
            Role.DEPTH_INFO, replace(info_message(0), width=WIDTH // 2, height=HEIGHT // 2, k=half)
        )
    ]
    topic = "/camera/aligned_depth_to_color/camera_info"
    messages = [*infos, *of_role(Role.DEPTH, halved)]
    write_bag(tmp_path / "bag", messages, topics={**TOPICS, Role.DEPTH_INFO: topic})
    numbers, voxels, _ = estimate_of(tmp_path / "bag")
    np.testing.assert_allclose(numbers, expected[0], rtol=0.25)
    assert voxels == pytest.approx(expected[1], rel=0.1)
