# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Images: every encoding, step and byte order; units; refusals by name; nothing crashes."""

import contextlib
import struct

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reflest_core.capture.images.decode import (
    COLOUR_ENCODINGS,
    DEPTH_ENCODINGS,
    decode_colour,
    decode_depth,
    decode_mask,
)
from reflest_core.capture.messages import CompressedImageMessage, ImageMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause

RGB = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)
MILLIMETRES = np.array([[0, 1, 500], [1234, 65534, 65535]], dtype=np.uint16)
METRES = np.array([[0, 0.001, 0.5], [1.234, 65.534, 0]], dtype=np.float32)


def message(pixels, encoding, step=None, is_bigendian=False, padding=0xEE):
    """An image message with rows padded to ``step``."""
    height, width = pixels.shape[:2]
    rows = [row.tobytes() for row in pixels]
    step = len(rows[0]) if step is None else step
    data = b"".join(row + bytes([padding]) * (step - len(row)) for row in rows)
    return ImageMessage(0, "camera", height, width, encoding, is_bigendian, step, data)


def with_alpha(pixels):
    return np.concatenate([pixels, np.full((2, 3, 1), 77, np.uint8)], axis=2)


@pytest.mark.parametrize("step", [None, 19])
@pytest.mark.parametrize(
    ("encoding", "pixels"),
    [
        ("rgb8", RGB),
        ("bgr8", RGB[:, :, ::-1]),
        ("rgba8", with_alpha(RGB)),
        ("bgra8", with_alpha(RGB[:, :, ::-1])),
    ],
)
def test_colour_encodings_give_the_same_rgb(encoding, pixels, step):
    assert np.array_equal(decode_colour(message(pixels, encoding, step), "/c"), RGB)


RED_PATCH = np.tile(np.array([200, 90, 30], np.uint8), (8, 8, 1))


@pytest.mark.parametrize("pattern", ["rggb", "bggr", "gbrg", "grbg"])
def test_bayer_patterns_give_red_green_and_blue(pattern):
    raw = np.empty((8, 8), np.uint8)
    for place, name in enumerate(pattern):
        raw[place // 2 :: 2, place % 2 :: 2] = RED_PATCH[0, 0, "rgb".index(name)]
    decoded = decode_colour(message(raw, f"bayer_{pattern}8"), "/c")
    assert np.array_equal(decoded, RED_PATCH)


@pytest.mark.parametrize(
    ("encoding", "order"), [("yuv422", "uyvy"), ("uyvy", "uyvy"), ("yuv422_yuy2", "yuyv")]
)
def test_yuv422_gives_red_green_and_blue(encoding, order):
    luma, u, v = cv2.cvtColor(RED_PATCH, cv2.COLOR_RGB2YUV_I420).ravel()[[0, 64, 80]]
    pairs = {"uyvy": (u, luma, v, luma), "yuyv": (luma, u, luma, v)}[order]
    raw = np.tile(np.array(pairs, np.uint8), (8, 4)).reshape(8, 8, 2)
    decoded = decode_colour(message(raw, encoding), "/c")
    assert np.abs(decoded.astype(int) - RED_PATCH).max() <= 3


def test_yuv422_of_an_odd_width_is_refused():
    with pytest.raises(FrameRefused, match="even width"):
        decode_colour(message(np.zeros((2, 3, 2), np.uint8), "yuv422"), "/c")


def test_mono16_is_depth_where_the_topic_is_chosen_as_depth():
    same = decode_depth(message(MILLIMETRES, "16UC1"), "/d", 0.001)
    assert np.array_equal(decode_depth(message(MILLIMETRES, "mono16"), "/d", 0.001), same)


def test_rotated_bits_are_turned_back():
    """SUN RGB-D and APC store d << 3 | d >> 13."""
    units = np.array([[0, 1, 4440], [8191, 8192, 12345]], np.uint16)
    stored = (units << 3) | (units >> 13)
    depth = decode_depth(message(stored, "16UC1"), "/d", 0.0001, is_rotated=True)
    np.testing.assert_allclose(depth, units * 0.0001, rtol=1e-6)


def test_grey_is_repeated_into_three_channels():
    decoded = decode_colour(message(RGB[:, :, 0], "mono8"), "/c")
    assert np.array_equal(decoded, np.repeat(RGB[:, :, :1], 3, axis=2))


@pytest.mark.parametrize("is_bigendian", [False, True])
@pytest.mark.parametrize("step", [None, 32])
def test_both_depth_encodings_give_the_same_metres(is_bigendian, step):
    order = ">" if is_bigendian else "<"
    units = message(MILLIMETRES.astype(f"{order}u2"), "16UC1", step, is_bigendian)
    floats = message(METRES.astype(f"{order}f4"), "32FC1", step, is_bigendian)
    assert np.array_equal(decode_depth(units, "/d", 0.001), METRES)
    assert np.array_equal(decode_depth(floats, "/d", 0.001), METRES)


@given(st.integers(1, 65534))
def test_a_millimetre_count_equals_its_float_in_metres(count):
    units = message(np.full((1, 1), count, "<u2"), "16UC1")
    floats = message(np.full((1, 1), count * 0.001, "<f4"), "32FC1")
    assert decode_depth(units, "/d", 0.001) == decode_depth(floats, "/d", 0.001)


def test_depth_scale_turns_16_bit_units_alone():
    units = message(np.full((1, 2), 5000, "<u2"), "16UC1")
    floats = message(np.full((1, 2), 1.5, "<f4"), "32FC1")
    assert decode_depth(units, "/d", 1 / 5000) == pytest.approx(1.0)
    assert decode_depth(floats, "/d", 1 / 5000) == pytest.approx(1.5)


def test_depth_that_is_no_distance_becomes_unknown():
    values = np.array([[np.nan, np.inf, -np.inf, -1.0, 0.0, 2.0]], dtype="<f4")
    assert decode_depth(message(values, "32FC1"), "/d", 0.001).tolist() == [[0, 0, 0, 0, 0, 2]]


def test_mask_is_true_where_it_is_not_zero():
    mask = np.array([[0, 1], [255, 0]], np.uint8)
    assert decode_mask(message(mask, "mono8"), "/m").tolist() == [[False, True], [True, False]]


@pytest.mark.parametrize(
    ("decode", "encoding", "named"),
    [
        (lambda m: decode_colour(m, "/topic"), "bayer_rggb16", ["bayer_rggb16", "rgb8", "mono8"]),
        (lambda m: decode_colour(m, "/topic"), "16UC1", ["16UC1", "--rgb-topic"]),
        (lambda m: decode_depth(m, "/topic", 0.001), "8UC1", ["8UC1", "16UC1", "32FC1"]),
        (lambda m: decode_mask(m, "/topic"), "rgb8", ["rgb8", "mono8", "--mask-topic"]),
    ],
)
def test_another_encoding_is_refused_by_name(decode, encoding, named):
    with pytest.raises(FrameRefused) as refused:
        decode(message(RGB, encoding))
    assert refused.value.cause is RefusalCause.ENCODING
    for word in ["/topic", *named]:
        assert word in str(refused.value)


@pytest.mark.parametrize(
    ("fields", "cause"),
    [
        ({"data": bytes(17)}, RefusalCause.TRUNCATED),
        ({"data": b""}, RefusalCause.TRUNCATED),
        ({"data": bytes(19)}, RefusalCause.SIZE),
        ({"step": 8}, RefusalCause.SIZE),
        ({"step": 0}, RefusalCause.SIZE),
        ({"height": 0}, RefusalCause.SIZE),
        ({"width": 2**32 - 1}, RefusalCause.SIZE),
        ({"height": 2**32 - 1, "step": 2**32 - 1}, RefusalCause.TRUNCATED),
    ],
)
def test_sizes_that_do_not_fit_are_refused(fields, cause):
    values = {"height": 2, "width": 3, "step": 9, "data": bytes(18)} | fields
    bad = ImageMessage(0, "c", encoding="rgb8", is_bigendian=False, **values)
    with pytest.raises(FrameRefused, match="/c") as refused:
        decode_colour(bad, "/c")
    assert refused.value.cause is cause


def encoded(suffix, pixels):
    return cv2.imencode(suffix, pixels)[1].tobytes()


def compressed(data, form):
    return CompressedImageMessage(0, "camera", form, data)


def test_png_colour_is_exact_and_jpeg_close():
    smooth = np.zeros((16, 16, 3), np.uint8) + np.array([200, 100, 50], np.uint8)
    png = compressed(encoded(".png", smooth[:, :, ::-1]), "rgb8; png compressed bgr8")
    jpeg = compressed(encoded(".jpg", smooth[:, :, ::-1]), "jpeg")
    assert np.array_equal(decode_colour(png, "/c"), smooth)
    assert np.abs(decode_colour(jpeg, "/c").astype(int) - smooth).max() <= 3


def test_png_and_compressed_depth_give_metres():
    png = encoded(".png", MILLIMETRES)
    packed = struct.pack("<iff", 0, 0.0, 0.0) + png
    for data, form in [(png, "16UC1; png"), (packed, "16UC1; compressedDepth png")]:
        assert np.array_equal(decode_depth(compressed(data, form), "/d", 0.001), METRES)


def test_float_compressed_depth_is_unquantised():
    # compressedDepth stores a / depth + b, so depth = a / (value - b).
    a, b = 1000.0, 5.0
    values = np.array([[0, 505, 1005]], np.uint16)
    data = struct.pack("<iff", 0, a, b) + encoded(".png", values)
    depth = decode_depth(compressed(data, "32FC1; compressedDepth png"), "/d", 0.001)
    assert depth.tolist() == [[0.0, 2.0, 1.0]]


@pytest.mark.parametrize("suffix", [".png", ".jpg"])
def test_a_cut_compressed_image_is_refused_wherever_it_is_cut(suffix):
    # Real decoders fill the rest with grey: the refusal is ours.
    pixels = np.random.default_rng(1).integers(0, 255, (32, 32, 3)).astype(np.uint8)
    data = encoded(suffix, pixels)
    for length in range(0, len(data) - 8, 37):
        with pytest.raises(FrameRefused) as refused:
            decode_colour(compressed(data[:length], suffix), "/c")
        assert refused.value.cause in (RefusalCause.TRUNCATED, RefusalCause.ENCODING)


@pytest.mark.parametrize(
    ("decode", "data", "form"),
    [
        (lambda m: decode_colour(m, "/t"), encoded(".png", MILLIMETRES), "png"),
        (lambda m: decode_depth(m, "/t", 0.001), encoded(".jpg", RGB), "jpeg"),
        (lambda m: decode_depth(m, "/t", 0.001), encoded(".png", RGB), "png"),
        (lambda m: decode_mask(m, "/t"), encoded(".jpg", RGB), "jpeg"),
        (lambda m: decode_colour(m, "/t"), b"RIFF....WEBPVP8 ", "webp"),
        (lambda m: decode_depth(m, "/t", 0.001), bytes(40), "16UC1; compressedDepth zstd"),
    ],
)
def test_another_compressed_format_is_refused_by_name(decode, data, form):
    with pytest.raises(FrameRefused, match=form) as refused:
        decode(compressed(data, form))
    assert refused.value.cause is RefusalCause.ENCODING


def test_a_decompression_bomb_is_refused_before_it_is_unpacked():
    header = b"\x89PNG\r\n\x1a\n" + struct.pack(">I4sIIBB", 13, b"IHDR", 2**30, 2**30, 8, 2)
    with pytest.raises(FrameRefused) as refused:
        decode_colour(compressed(header + b"IEND", "png"), "/c")
    assert refused.value.cause is RefusalCause.SIZE


sizes = st.one_of(st.integers(0, 20), st.integers(0, 2**32 - 1))
encodings = st.one_of(st.sampled_from([*COLOUR_ENCODINGS, *DEPTH_ENCODINGS, "8UC1"]), st.text())
images = st.builds(
    ImageMessage,
    stamp_ns=st.integers(),
    frame_id=st.text(),
    height=sizes,
    width=sizes,
    encoding=encodings,
    is_bigendian=st.booleans(),
    step=sizes,
    data=st.binary(max_size=2000),
)
magic = st.sampled_from([b"", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff\xe0", bytes(12)])
packed_images = st.builds(
    CompressedImageMessage,
    stamp_ns=st.integers(),
    frame_id=st.text(),
    format=st.one_of(
        st.text(), st.sampled_from(["jpeg", "png", "16UC1; compressedDepth", "32FC1; png"])
    ),
    data=st.builds(lambda start, rest: start + rest, magic, st.binary(max_size=500)),
)


@settings(max_examples=500)
@given(st.one_of(images, packed_images))
def test_garbage_is_decoded_or_refused_and_never_crashes(garbage):
    for decode, kind in (
        (lambda: decode_colour(garbage, "/t"), np.uint8),
        (lambda: decode_depth(garbage, "/t", 0.001), np.float32),
        (lambda: decode_mask(garbage, "/t"), np.bool_),
    ):
        try:
            assert decode().dtype == kind
        except FrameRefused as refusal:
            assert refusal.cause in (
                RefusalCause.ENCODING,
                RefusalCause.SIZE,
                RefusalCause.TRUNCATED,
            )


@st.composite
def padded_depth(draw):
    height, width = draw(st.integers(1, 6)), draw(st.integers(1, 6))
    values = draw(st.lists(st.integers(0, 65534), min_size=height * width, max_size=height * width))
    step = 2 * width + draw(st.integers(0, 9))
    return np.array(values, np.uint16).reshape(height, width), step, draw(st.booleans())


@given(padded_depth(), st.integers(0, 255))
def test_padding_and_byte_order_never_show(case, padding):
    values, step, is_bigendian = case
    sent = values.astype(">u2" if is_bigendian else "<u2")
    decoded = decode_depth(message(sent, "16UC1", step, is_bigendian, padding), "/d", 0.001)
    assert np.array_equal(np.round(decoded * 1000), values)


@settings(max_examples=300)
@given(st.integers(0, 10**6), st.integers(0, 255), st.sampled_from([".png", ".jpg"]))
def test_a_flipped_byte_never_crashes_the_decoder(position, value, suffix):
    data = bytearray(encoded(suffix, np.tile(RGB, (8, 8, 1))))
    data[position % len(data)] = value
    with contextlib.suppress(FrameRefused):  # a refusal is the other allowed outcome
        assert decode_colour(compressed(bytes(data), suffix), "/c").ndim == 3
