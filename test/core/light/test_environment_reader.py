# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Radiance as other programs wrote it."""

import os

import cv2
import numpy as np
import OpenEXR
import pytest

from reflest_core.light import environment_reader
from reflest_core.light.environment_reader import read_radiance

RADIANCE = np.random.default_rng(1).random((16, 32, 3)).astype(np.float32) * 40
ALPHA = np.random.default_rng(2).random((16, 32)).astype(np.float32)


def write_exr(path, channels, **header):
    OpenEXR.File(
        {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION, **header}, channels
    ).write(str(path))
    return path


def test_exr_with_alpha_is_read_to_the_bit(tmp_path):
    image = read_radiance(
        write_exr(tmp_path / "a.exr", {"RGBA": np.dstack([RADIANCE, ALPHA[..., None]])})
    )
    np.testing.assert_array_equal(image.radiance, RADIANCE)
    np.testing.assert_array_equal(image.coverage, ALPHA)


def test_exr_of_half_floats_without_alpha(tmp_path):
    image = read_radiance(write_exr(tmp_path / "A.EXR", {"RGB": RADIANCE.astype(np.float16)}))
    np.testing.assert_array_equal(image.radiance, RADIANCE.astype(np.float16))
    assert image.radiance.dtype == np.float32
    assert image.coverage is None


def test_hdr_is_read_in_the_order_red_green_blue(tmp_path):
    cv2.imwrite(str(tmp_path / "a.hdr"), np.ascontiguousarray(RADIANCE[..., ::-1]))
    image = read_radiance(tmp_path / "a.hdr")
    step = RADIANCE.max(axis=-1, keepdims=True) / 100
    assert (np.abs(image.radiance - RADIANCE) <= step).all()
    assert image.coverage is None


def test_other_channels_are_named(tmp_path):
    path = write_exr(tmp_path / "depth.exr", {"Z": ALPHA})
    with pytest.raises(ValueError, match="channels are Z, but R, G and B"):
        read_radiance(path)


@pytest.mark.parametrize("name", ["a.exr", "a.hdr"])
def test_a_file_of_something_else_is_refused(tmp_path, name):
    (tmp_path / name).write_bytes(b"#?RADIANCE\nnothing more")
    with pytest.raises(ValueError, match="image"):
        read_radiance(tmp_path / name)


@pytest.mark.parametrize("name", ["a.exr", "a.hdr"])
def test_a_missing_file_is_the_systems_error(tmp_path, name):
    with pytest.raises(FileNotFoundError):
        read_radiance(tmp_path / name)


def test_a_truncated_exr_is_refused(tmp_path):
    path = write_exr(tmp_path / "a.exr", {"RGB": RADIANCE})
    path.write_bytes(path.read_bytes()[:900])
    with pytest.raises(ValueError, match="damaged"):
        read_radiance(path)


def test_an_absurd_size_is_refused_before_memory_is_taken(tmp_path):
    (tmp_path / "a.hdr").write_bytes(
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n" + bytes(100)
    )
    with pytest.raises(ValueError, match="60000 x 60000 pixels, more than"):
        read_radiance(tmp_path / "a.hdr")


@pytest.mark.parametrize("name", ["a.exr", "a.hdr"])
def test_a_file_larger_than_any_image_is_not_read(tmp_path, name):
    with (tmp_path / name).open("wb") as file:
        file.truncate(2**40)
    with pytest.raises(ValueError, match="1048576 MB, more than"):
        read_radiance(tmp_path / name)


@pytest.mark.parametrize("name", ["a.exr", "a.hdr"])
def test_a_pipe_is_refused_without_waiting_for_it(tmp_path, name):
    os.mkfifo(tmp_path / name)
    with pytest.raises(ValueError, match="no regular file"):
        read_radiance(tmp_path / name)


def test_an_exr_of_many_channels_is_not_decoded(tmp_path, monkeypatch):
    monkeypatch.setattr(environment_reader, "MOST_VALUES", 16 * 32 * 4)
    path = write_exr(tmp_path / "passes.exr", {name: ALPHA for name in "RGBAZ"})
    with pytest.raises(ValueError, match="5 channels of 32 x 16 pixels: keep R, G, B and A"):
        read_radiance(path)
