# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""RVL depth: a slow encoder written from the paper and the decoder agree; damage is refused."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from reflest_core.capture.images.decode import decode_depth
from reflest_core.capture.images.rvl import decode_rvl
from reflest_core.capture.messages import CompressedImageMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause

images = arrays(
    np.uint16,
    array_shapes(min_dims=2, max_dims=2, max_side=12),
    elements=st.one_of(st.just(0), st.integers(0, 65535)),
)


def groups_of(number):
    """A number as hexadecimal digits: three bits each, lowest first, 8 is added where more come."""
    digits = []
    while True:
        number, digit = divmod(number, 8)
        digits.append(digit + (8 if number else 0))
        if not number:
            return "".join(f"{digit:x}" for digit in digits)


def encoded(image):
    """The stream of an image, as hexadecimal text turned into words."""
    values = image.ravel().tolist()
    text, at, previous = "", 0, 0
    while at < len(values):
        zeros = next((n for n, value in enumerate(values[at:]) if value), len(values) - at)
        at += zeros
        others = next((n for n, value in enumerate(values[at:]) if not value), len(values) - at)
        text += groups_of(zeros) + groups_of(others)
        for value in values[at : at + others]:
            difference, previous = value - previous, value
            text += groups_of(2 * difference if difference >= 0 else -2 * difference - 1)
        at += others
    text += "0" * (-len(text) % 8)
    return b"".join(struct.pack("<I", int(text[n : n + 8], 16)) for n in range(0, len(text), 8))


def message(image, form="16UC1; compressedDepth rvl", a=0.0, b=0.0):
    size = struct.pack("<II", image.shape[1], image.shape[0])
    data = struct.pack("<iff", 0, a, b) + size + encoded(image)
    return CompressedImageMessage(0, "camera", form, data)


def test_a_stream_written_by_hand():
    # One 0, then three pixels: 5 (zigzag 10 = 2, then 1), 6 (zigzag 2), 4 (zigzag 3).
    stream = struct.pack("<I", int("13" + "a1" + "2" + "3" + "00", 16))
    assert decode_rvl(stream, 2, 2).tolist() == [[0, 5], [6, 4]]


@settings(max_examples=300)
@given(images)
def test_what_was_encoded_comes_out(image):
    assert np.array_equal(decode_rvl(encoded(image), *image.shape), image)


@settings(max_examples=300)
@given(st.binary(max_size=64), st.integers(1, 20), st.integers(1, 20))
def test_any_bytes_are_decoded_or_refused(data, height, width):
    image = decode_rvl(data, height, width)
    assert image is None or image.shape == (height, width)


@given(images.filter(np.any), st.data())
def test_a_cut_stream_is_refused_or_whole(image, data):
    stream = encoded(image)
    cut = data.draw(st.integers(0, len(stream) - 4))
    assert decode_rvl(stream[:cut], *image.shape) is None


def test_compressed_depth_rvl_gives_metres():
    millimetres = np.array([[0, 500, 1234], [65534, 65535, 1]], np.uint16)
    metres = decode_depth(message(millimetres), "/d", 0.001)
    assert np.allclose(metres, [[0, 0.5, 1.234], [65.534, 0, 0.001]])


def test_float_compressed_depth_is_unquantised():
    values = np.array([[0, 505, 1005]], np.uint16)
    depth = decode_depth(message(values, "32FC1; compressedDepth rvl", 1000.0, 5.0), "/d", 0.001)
    assert depth.tolist() == [[0.0, 2.0, 1.0]]


@pytest.mark.parametrize("length", [0, 11, 12, 19, 20])
def test_a_message_that_ends_in_its_headers_is_refused(length):
    whole = message(np.full((3, 3), 7, np.uint16))
    cut = CompressedImageMessage(0, "", whole.format, whole.data[:length])
    with pytest.raises(FrameRefused) as refusal:
        decode_depth(cut, "/d", 0.001)
    assert refusal.value.cause is RefusalCause.TRUNCATED


@pytest.mark.parametrize("size", [(2**31, 2**31), (0, 5)])
def test_an_absurd_size_is_refused_before_memory_is_asked_for(size):
    data = bytes(12) + struct.pack("<II", *size) + bytes(40)
    absurd = CompressedImageMessage(0, "", "16UC1; compressedDepth rvl", data)
    with pytest.raises(FrameRefused) as refusal:
        decode_depth(absurd, "/d", 0.001)
    assert refusal.value.cause is RefusalCause.SIZE
