# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Bytes damaged at random, of every kind that is read: an answer or one sentence, nothing else.

``make stress`` reads more than a million of them. A seed gives each case again.
"""

from __future__ import annotations

import contextlib

import cv2
import numpy as np
import pytest

from reflest_core.array_file import read_array
from reflest_core.capture.images.decode import decode_colour, decode_depth
from reflest_core.capture.messages import CompressedImageMessage
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import FrameRefused
from reflest_core.environment.known_rooms import read_known_light
from reflest_core.errors import ReflestError
from reflest_core.models.weights import load_weights
from reflest_core.parameter_file import read_parameter_file
from reflest_core.ply_file import read_vertices
from test.core.capture.images.test_rvl import message as rvl_message
from test.core.capture.recording import recording, write_bag
from test.core.weight_files import untrained
from test.stress import repeats

SMALL = np.arange(24 * 18, dtype=np.uint16).reshape(18, 24) * 9 + 400
PARAMETERS = """\
/**:
  ros__parameters:
    fusion: {voxel_size: 0.01, max_depth: 2.5}
    region: {shape: sphere, centre: [0.0, 0.0, 0.12], size: [0.35, 0.35, 0.35]}
"""
PLY = (
    b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
    b"property float y\nproperty uchar red\nend_header\n" + bytes(27)
)
INSERTED = 64
"""Bytes at most that a damage puts in, takes out or repeats."""


def damaged(data: bytes, random: np.random.Generator) -> bytes:
    """``data`` with one to four places overwritten, cut out, repeated, or ended there."""
    content = bytearray(data)
    for _ in range(random.integers(1, 5)):
        if not content:
            break
        place, length = int(random.integers(len(content))), int(random.integers(1, INSERTED))
        match random.integers(6):
            case 0:
                content[place] ^= 1 << int(random.integers(8))
            case 1:
                content[place : place + length] = random.bytes(length)
            case 2:
                del content[place : place + length]
            case 3:
                content[place:place] = content[place : place + length]
            case 4:
                content[place : place + 8] = bytes([int(random.choice([0, 127, 128, 255]))] * 8)
            case _:
                del content[place:]
    return bytes(content)


def encoded(suffix, pixels):
    return cv2.imencode(suffix, pixels)[1].tobytes()


def compressed(form):
    """Reader of a compressed image's bytes."""

    def read(data):
        message = CompressedImageMessage(0, "camera", form, data)
        if "16UC1" in form:
            assert np.isfinite(decode_depth(message, "/d", 0.001)).all()
        else:
            assert decode_colour(message, "/c").dtype == np.uint8

    return read


IMAGES = {
    "jpeg": ("jpeg", encoded(".jpg", (SMALL[..., None] // 20).astype(np.uint8).repeat(3, 2))),
    "png": ("png", encoded(".png", (SMALL // 20).astype(np.uint8))),
    "depth-png": ("16UC1; png", encoded(".png", SMALL)),
    "rvl": ("16UC1; compressedDepth rvl", rvl_message(SMALL).data),
}


@pytest.mark.parametrize("kind", IMAGES)
def test_damaged_images_are_decoded_or_refused(kind):
    form, data = IMAGES[kind]
    read, random = compressed(form), np.random.default_rng(1)
    for _ in range(repeats(500, 240_000)):
        with contextlib.suppress(FrameRefused):
            read(damaged(data, random))


def _ply(path):
    read_vertices(path)


def _array(path):
    read_array(path)


def _opened(path):
    capture = open_capture(path)
    for frame in capture:
        assert np.isfinite(frame.T_world_camera).all()


SAMPLES = {
    "parameters.yaml": (read_parameter_file, ReflestError, 20_000),
    "vertices.ply": (_ply, ValueError, 60_000),
    "array.npy": (_array, ValueError, 60_000),
    "weights.safetensors": (load_weights, ReflestError, 30_000),
    "light.hdr": (read_known_light, ReflestError, 10_000),
    "bag.mcap": (_opened, ReflestError, 10_000),
    "bag.db3": (_opened, ReflestError, 10_000),
}
"""A file's reader, what it may raise, and how many are read by ``make stress``."""


@pytest.fixture(scope="module")
def samples(tmp_path_factory):
    folder = tmp_path_factory.mktemp("samples")
    np.save(folder / "array.npy", SMALL)
    messages = recording(2)
    return {
        "parameters.yaml": PARAMETERS.encode(),
        "vertices.ply": PLY,
        "array.npy": (folder / "array.npy").read_bytes(),
        "weights.safetensors": untrained("hemicnn", folder).read_bytes(),
        "light.hdr": encoded(".hdr", np.ones((8, 16, 3), np.float32)),
        "bag.mcap": write_bag(folder / "mcap", messages).read_bytes(),
        "bag.db3": write_bag(folder / "sqlite3", messages, storage="sqlite3").read_bytes(),
    }


@pytest.mark.parametrize("name", SAMPLES)
def test_damaged_files_are_read_or_refused(samples, name, tmp_path):
    read, refusal, many = SAMPLES[name]
    random = np.random.default_rng(1)
    path = tmp_path / name
    for _ in range(repeats(30, many)):
        path.write_bytes(damaged(samples[name], random))
        with contextlib.suppress(refusal):
            read(path)
