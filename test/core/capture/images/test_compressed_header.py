# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is read of a compressed image without unpacking it, wherever it was cut off."""

import zlib

import cv2
import numpy as np
import pytest

from reflest_core.capture.images.compressed_header import read_header
from reflest_core.capture.images.decode import decode_colour
from reflest_core.capture.messages import CompressedImageMessage
from reflest_core.capture.refusal import FrameRefused

HEIGHT, WIDTH = 30, 40


@pytest.mark.parametrize(("suffix", "kind"), [(".jpg", "jpeg"), (".png", "png")])
def test_a_cut_off_image_is_known_by_its_size_or_not_at_all(suffix, kind):
    image = np.arange(HEIGHT * WIDTH * 3, dtype=np.uint32).astype(np.uint8)
    _, encoded = cv2.imencode(suffix, image.reshape(HEIGHT, WIDTH, 3))
    data = encoded.tobytes()
    headers = [read_header(data[:length]) for length in range(len(data) + 1)]
    whole = headers[-1]
    assert (whole.kind, whole.width, whole.height) == (kind, WIDTH, HEIGHT)
    assert (whole.bit_depth, whole.channels, whole.is_complete) == (8, 3, True)
    first = next(length for length, header in enumerate(headers) if header is not None)
    for header in headers[first:]:
        assert (header.width, header.height, header.channels) == (WIDTH, HEIGHT, 3)
    assert not headers[first].is_complete
    assert all(header is None for header in headers[:first])


@pytest.mark.parametrize("suffix", [".jpg", ".png"])
@pytest.mark.parametrize("padding", [bytes(512), b"\xff" * 70, bytes(range(256)) * 8])
def test_padding_after_the_end_is_no_damage(suffix, padding):
    """Drivers hand over MJPEG buffers of fixed size."""
    image = np.full((HEIGHT, WIDTH, 3), 90, np.uint8)
    data = cv2.imencode(suffix, image)[1].tobytes() + padding
    assert read_header(data).is_complete
    message = CompressedImageMessage(0, "camera", suffix, data)
    assert np.abs(decode_colour(message, "/c").astype(int) - 90).max() <= 1


def test_the_end_of_a_thumbnail_is_not_the_images_end():
    whole = cv2.imencode(".jpg", np.full((HEIGHT, WIDTH, 3), 90, np.uint8))[1].tobytes()
    thumbnail = b"\xff\xe1" + (2 + 6 + len(whole)).to_bytes(2, "big") + b"Exif\0\0" + whole
    with_thumbnail = whole[:2] + thumbnail + whole[2:]
    assert read_header(with_thumbnail).is_complete
    assert not read_header(with_thumbnail[:-20]).is_complete


@pytest.mark.parametrize("length", [1_000, 2**31, 2**32 - 1])
@pytest.mark.parametrize("kind", [b"IDAT", b"IEND"])
def test_a_part_that_declares_more_than_there_is_is_damage(kind, length):
    """OpenCV would take 4 GB for 186 bytes."""
    data = cv2.imencode(".png", np.full((HEIGHT, WIDTH, 3), 90, np.uint8))[1].tobytes()
    place = data.index(kind) - 4
    changed = data[:place] + length.to_bytes(4, "big") + data[place + 4 :]
    assert (read_header(changed).width, read_header(changed).is_complete) == (WIDTH, False)
    with pytest.raises(FrameRefused, match="damaged"):
        decode_colour(CompressedImageMessage(0, "camera", "png", changed), "/c")


def test_an_animation_is_no_image():
    data = cv2.imencode(".png", np.full((HEIGHT, WIDTH, 3), 90, np.uint8))[1].tobytes()
    place = data.index(b"IDAT") - 4
    control = b"acTL" + (2).to_bytes(4, "big") + bytes(4)
    chunk = (8).to_bytes(4, "big") + control + zlib.crc32(control).to_bytes(4, "big")
    assert not read_header(data[:place] + chunk + data[place:]).is_complete
