# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Calibration: every field checked, ROI and binning applied, distortion taken out or refused."""

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.capture.camera_info import check_camera_info
from reflest_core.capture.images.rectify import CheckedCamera, Rectifier
from reflest_core.capture.messages import CameraInfoMessage
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.capture.settings import CaptureSettings

SETTINGS = CaptureSettings()
K = (500.0, 0.0, 320.0, 0.0, 510.0, 240.0, 0.0, 0.0, 1.0)
INFO = CameraInfoMessage(0, "camera", 640, 480, K)
RATIONAL = (0.5, -2.5, 0.001, 0.0003, 1.5, 0.4, -2.3, 1.4)
PLUMB_BOB = (-0.3, 0.1, 0.001, -0.002, 0.0)


def test_the_fields_become_intrinsics():
    camera = check_camera_info(INFO, "/info", SETTINGS)
    assert camera.intrinsics.matrix.ravel().tolist() == list(K)
    assert (camera.intrinsics.width, camera.intrinsics.height) == (640, 480)
    assert camera.distortion == ()


def test_roi_and_binning_are_applied_as_image_geometry_does():
    info = replace(INFO, roi=(100, 40, 400, 200), binning=(2, 4))
    camera = check_camera_info(info, "/info", SETTINGS).intrinsics
    assert (camera.width, camera.height) == (200, 50)
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (250.0, 127.5, 110.0, 50.0)


def test_a_region_of_interest_may_be_the_upper_left_quarter():
    info = replace(INFO, roi=(0, 0, 320, 240))
    camera = check_camera_info(info, "/info", SETTINGS).intrinsics
    assert (camera.width, camera.cx, camera.cy) == (320, 320.0, 240.0)
    with pytest.raises(FrameRefused, match="2 times as large"):
        check_camera_info(replace(INFO, width=320, height=240), "/info", SETTINGS)


def test_rectified_images_use_p_and_need_no_distortion():
    p = (400.0, 0.0, 300.0, 0.0, 0.0, 410.0, 200.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    info = replace(INFO, p=p, d=PLUMB_BOB, distortion_model="plumb_bob")
    camera = check_camera_info(info, "/info", replace(SETTINGS, rectified=True))
    assert (camera.intrinsics.fx, camera.intrinsics.cy) == (400.0, 200.0)
    assert camera.distortion == ()


@pytest.mark.parametrize(
    ("fields", "word"),
    [
        ({"k": (0.0,) * 9}, "fx = 0"),
        ({"k": (math.nan, *K[1:])}, "fx = nan"),
        ({"k": (-500.0, *K[1:])}, "fx = -500"),
        ({"k": (500.0, 0.1, *K[2:])}, "skew = 0.1"),
        ({"k": K[:6]}, "6 values"),
        ({"width": 0}, "0 x 480"),
        ({"d": PLUMB_BOB, "distortion_model": "thin_prism"}, "'thin_prism'"),
        ({"d": (0.1, 0.0), "distortion_model": "equidistant"}, "'equidistant'"),
        ({"d": PLUMB_BOB, "distortion_model": ""}, "''"),
        ({"d": PLUMB_BOB[:3], "distortion_model": "plumb_bob"}, "3 coefficients"),
        ({"d": (math.nan,) * 5, "distortion_model": "plumb_bob"}, "NaN"),
        ({"d": (1e300, *PLUMB_BOB[1:]), "distortion_model": "plumb_bob"}, "beyond 1e+06"),
        ({"d": (1e300, 0.0, 0.0, 0.0), "distortion_model": "equidistant"}, "beyond 1e+06"),
        ({"k": (1e-3, 0.0, 320.0, 0.0, 1e-3, *K[5:])}, "field of view"),
    ],
)
def test_a_bad_field_is_refused_and_named(fields, word):
    with pytest.raises(FrameRefused, match="/info") as refused:
        check_camera_info(replace(INFO, **fields), "/info", SETTINGS)
    assert refused.value.cause is RefusalCause.CAMERA_INFO_INVALID
    assert word in str(refused.value)


@pytest.mark.parametrize("model", ["plumb_bob", "rational_polynomial", "", "brown_conrady"])
def test_zero_coefficients_are_no_distortion(model):
    info = replace(INFO, d=(0.0,) * 5, distortion_model=model)
    assert check_camera_info(info, "/info", SETTINGS).distortion == ()


@pytest.mark.parametrize("model", ["plumb_bob", "rational_polynomial", "equidistant", "fisheye"])
def test_no_coefficients_are_no_distortion_under_any_model(model):
    camera = check_camera_info(replace(INFO, d=(), distortion_model=model), "/info", SETTINGS)
    assert camera.distortion == ()
    assert not camera.is_fisheye


@pytest.mark.parametrize(
    ("model", "coefficients"),
    [
        ("plumb_bob", PLUMB_BOB),
        ("rational_polynomial", RATIONAL),
        ("rational_polynomial", (*RATIONAL, 1e-3, -2e-4, 5e-4, 1e-4)),
        ("rational_polynomial", (*RATIONAL, 1e-3, -2e-4, 5e-4, 1e-4, 0.004, -0.003)),
        ("equidistant", (-0.02, 0.01, -0.004, 0.0005)),
        ("fisheye", (0.0, 0.0, 0.0, 0.0)),
    ],
)
def test_rectifying_undoes_the_distortion(model, coefficients):
    """A pattern drawn where OpenCV's own projection puts it comes back to its pinhole place."""
    info = replace(INFO, d=coefficients, distortion_model=model)
    camera = check_camera_info(info, "/info", SETTINGS)
    points = np.array([[x, y, 1.0] for x in (-0.4, 0.0, 0.35) for y in (-0.3, 0.0, 0.3)])
    matrix = camera.intrinsics.matrix
    project = cv2.fisheye.projectPoints if camera.is_fisheye else cv2.projectPoints
    distorted, _ = project(
        points[:, None], np.zeros(3), np.zeros(3), matrix, np.array(coefficients)
    )
    distorted = distorted.reshape(-1, 1, 2)
    depth = np.zeros((480, 640), np.float32)
    rgb = np.zeros((480, 640, 3), np.uint8)
    for number, (x, y) in enumerate(distorted[:, 0], start=1):
        depth[round(y) - 2 : round(y) + 3, round(x) - 2 : round(x) + 3] = number
        rgb[round(y) - 2 : round(y) + 3, round(x) - 2 : round(x) + 3] = number
    rectifier = Rectifier(camera)
    depth, colour = rectifier.depth(depth), rectifier.colour(rgb)
    mask = rectifier.mask(rgb[:, :, 0] > 0)
    for number, point in enumerate(points, start=1):
        x, y = np.rint((matrix @ point)[:2]).astype(int)
        assert depth[y, x] == number
        assert colour[y, x].tolist() == [number] * 3
        assert mask[y, x]
    assert set(np.unique(depth)) <= set(range(10)), "depth must not be blended across an edge"


counts = st.integers(0, 2**32 - 1)
infos = st.builds(
    CameraInfoMessage,
    stamp_ns=st.integers(),
    frame_id=st.text(),
    width=counts,
    height=counts,
    k=st.lists(st.floats(), max_size=10).map(tuple) | st.tuples(*[st.floats()] * 9),
    d=st.lists(st.floats(), max_size=15).map(tuple),
    distortion_model=st.sampled_from(["", "plumb_bob", "rational_polynomial", "equidistant"]),
    p=st.tuples(*[st.floats()] * 12),
    binning=st.tuples(counts, counts),
    roi=st.tuples(counts, counts, counts, counts),
)


@given(infos, st.booleans())
def test_any_info_gives_a_usable_camera_or_a_refusal(info, rectified):
    try:
        camera = check_camera_info(info, "/info", replace(SETTINGS, rectified=rectified))
    except FrameRefused as refusal:
        assert refusal.cause is RefusalCause.CAMERA_INFO_INVALID
        return
    values = camera.intrinsics
    assert values.width > 0
    assert values.height > 0
    assert np.isfinite(values.matrix).all()
    assert values.fx > 0
    assert values.fy > 0
    assert np.isfinite(camera.distortion).all()


P = (400.0, 0.0, 300.0, 0.0, 0.0, 410.0, 200.0, 0.0, 0.0, 0.0, 1.0, 0.0)


def camera_on(image_topic, **fields):
    """The camera of images on a topic, whether it rectifies them, and what is warned of."""
    heard = []
    info = replace(INFO, d=PLUMB_BOB, distortion_model="plumb_bob", **{"p": P, **fields})
    checked = CheckedCamera("/info", image_topic, SETTINGS, heard.append)
    cameras = [checked.of(replace(info, stamp_ns=stamp)) for stamp in (0, 1)]
    return cameras[0][0], cameras[0][1] is not None, heard


@pytest.mark.parametrize("name", ["/camera/image_rect", "/c/image_rect_color/compressed"])
def test_images_on_a_topic_named_image_rect_are_rectified_and_that_is_said_once(name):
    camera, is_rectified_here, heard = camera_on(name)
    assert camera.intrinsics.fx == 400.0
    assert not is_rectified_here
    assert len(heard) == 1
    assert "capture.rectified" in heard[0]


@pytest.mark.parametrize(
    ("name", "fields"),
    [
        ("/camera/image_raw", {}),
        ("/camera/image_rect", {"p": (0.0,) * 12}),
        ("/camera/image_rect", {"p": ()}),
    ],
)
def test_without_the_name_or_a_valid_p_distortion_is_taken_out(name, fields):
    camera, is_rectified_here, heard = camera_on(name, **fields)
    assert (camera.intrinsics.fx, is_rectified_here, heard) == (500.0, True, [])
