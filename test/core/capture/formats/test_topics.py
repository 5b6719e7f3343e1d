# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Topics are found where unambiguous; else the sentence lists candidates and the option."""

import pytest

from reflest_core.capture.formats.cdr import (
    CAMERA_INFO,
    COMPRESSED_IMAGE,
    IMAGE,
    ODOMETRY,
    POSE_STAMPED,
    TRANSFORMS,
)
from reflest_core.capture.formats.recorded_topics import CandidateTopic
from reflest_core.capture.formats.topics import TopicChoice, choose_topics
from reflest_core.capture.messages import Role
from reflest_core.capture.refusal import CaptureError

RGB = CandidateTopic("/cam/color/image_raw", IMAGE, "rgb8")
DEPTH = CandidateTopic("/cam/aligned/image_raw", IMAGE, "16UC1")
INFO = CandidateTopic("/cam/color/camera_info", CAMERA_INFO)
POSE = CandidateTopic("/pose", POSE_STAMPED)
OTHER = CandidateTopic("/imu", "sensor_msgs/msg/Imu")
ALL = [OTHER, POSE, INFO, DEPTH, RGB]


def choose(candidates, **named):
    return choose_topics(candidates, TopicChoice(**named), "bag")


def test_one_of_each_is_found_by_type_and_encoding():
    assert choose(ALL) == {
        Role.RGB: RGB.name,
        Role.DEPTH: DEPTH.name,
        Role.CAMERA_INFO: INFO.name,
        Role.POSE: POSE.name,
    }


def test_infrared_does_not_compete_with_colour_but_serves_without_it():
    infrared = CandidateTopic("/cam/infra1/image", IMAGE, "mono8")
    assert choose([*ALL, infrared])[Role.RGB] == RGB.name
    assert choose([*ALL[:-1], infrared])[Role.RGB] == infrared.name


def test_of_several_infos_the_one_beside_colour_is_taken():
    depth_info = CandidateTopic("/cam/aligned/camera_info", CAMERA_INFO)
    assert choose([*ALL, depth_info])[Role.CAMERA_INFO] == INFO.name
    packed = CandidateTopic("/cam/color/image_raw/compressed", COMPRESSED_IMAGE, "jpeg")
    assert choose([*ALL[:-1], packed, depth_info])[Role.CAMERA_INFO] == INFO.name


def test_compressed_depth_is_depth():
    packed = CandidateTopic(
        "/cam/d/compressedDepth", COMPRESSED_IMAGE, "16UC1; compressedDepth png"
    )
    chosen = choose([OTHER, POSE, INFO, RGB, packed])
    assert (chosen[Role.RGB], chosen[Role.DEPTH]) == (RGB.name, packed.name)


@pytest.mark.parametrize(
    ("second", "option"),
    [
        (CandidateTopic("/other/image", IMAGE, "bgr8"), "--rgb-topic"),
        (CandidateTopic("/other/depth", IMAGE, "32FC1"), "--depth-topic"),
        (CandidateTopic("/odom", ODOMETRY), "--pose-topic"),
    ],
)
def test_several_that_fit_are_listed_with_the_option(second, option):
    with pytest.raises(CaptureError) as error:
        choose([*ALL, second])
    assert option in str(error.value)
    assert str(second) in str(error.value)
    role = option[2:].split("-")[0]
    assert choose([*ALL, second], **{role: second.name})[Role(role)] == second.name


@pytest.mark.parametrize(
    ("absent", "words"),
    [
        (RGB, ["no rgb topic", DEPTH.name, "--rgb-topic"]),
        (DEPTH, ["no depth topic", "16UC1, 32FC1", RGB.name, "--depth-topic"]),
        (INFO, ["no camera_info topic", "/imu (Imu)"]),
        (POSE, ["no pose topic", "PoseStamped or nav_msgs/msg/Odometry", "/imu (Imu)"]),
    ],
)
def test_a_missing_topic_is_named_with_what_there_is(absent, words):
    with pytest.raises(CaptureError) as error:
        choose([topic for topic in ALL if topic is not absent])
    for word in words:
        assert word in str(error.value)


def test_an_encoding_that_is_not_read_is_shown():
    bayer = CandidateTopic("/cam/bayer", IMAGE, "bayer_rggb16")
    with pytest.raises(CaptureError, match=r"/cam/bayer \(Image, bayer_rggb16\)"):
        choose([*ALL[:-1], bayer])


TF = CandidateTopic("/tf", TRANSFORMS)
TF_STATIC = CandidateTopic("/tf_static", TRANSFORMS)


def test_poses_in_tf_alone_ask_for_the_world_frame():
    with pytest.raises(CaptureError, match="--world-frame"):
        choose([RGB, DEPTH, INFO, TF])


def test_with_poses_from_tf_no_pose_topic_is_needed():
    chosen = choose_topics([RGB, DEPTH, INFO, TF, TF_STATIC], TopicChoice(), "bag", "tf")
    assert Role.POSE not in chosen
    assert (chosen[Role.TF], chosen[Role.TF_STATIC]) == ("/tf", "/tf_static")
    with pytest.raises(CaptureError, match="no /tf or /tf_static"):
        choose_topics(ALL, TopicChoice(), "bag", "tf")


def test_one_robots_tf_in_a_namespace_is_found_and_several_are_not_mixed():
    first, second = (CandidateTopic(f"/{name}/tf", TRANSFORMS) for name in ("one", "two"))
    assert choose([*ALL, first])[Role.TF] == "/one/tf"
    assert Role.TF not in choose([*ALL, first, second])
    assert choose([*ALL, first, second, TF])[Role.TF] == "/tf"


def test_the_depth_cameras_info_is_found_beside_depth_or_named():
    beside = CandidateTopic("/cam/aligned/camera_info", CAMERA_INFO)
    other = CandidateTopic("/cam/depth_info", CAMERA_INFO)
    assert Role.DEPTH_INFO not in choose(ALL)
    assert choose([*ALL, beside])[Role.DEPTH_INFO] == beside.name
    named = choose([*ALL, beside, other], depth_camera_info=other.name)
    assert named[Role.DEPTH_INFO] == other.name
    with pytest.raises(CaptureError, match="--depth-camera-info-topic"):
        choose(ALL, depth_camera_info="/nothing")


@pytest.mark.parametrize("name", ["/nothing", "/pose"])
def test_a_named_topic_that_cannot_be_it_lists_what_can(name):
    with pytest.raises(CaptureError) as error:
        choose(ALL, depth=name)
    assert name in str(error.value)
    assert str(DEPTH) in str(error.value)


def test_a_mask_is_used_only_where_named():
    mask = CandidateTopic("/mask", IMAGE, "mono8")
    assert Role.MASK not in choose([*ALL, mask])
    assert choose([*ALL, mask], mask="/mask")[Role.MASK] == "/mask"


def test_of_an_image_and_its_compressed_copies_the_best_is_taken():
    """A recorder told to take everything takes each image several times."""
    packed_rgb = CandidateTopic(f"{RGB.name}/compressed", COMPRESSED_IMAGE, "rgb8; jpeg")
    png, rvl = (
        CandidateTopic(f"{DEPTH.name}/{name}", COMPRESSED_IMAGE, form)
        for name, form in (
            ("compressed", "16UC1; png compressed"),
            ("compressedDepth", "16UC1; compressedDepth"),
        )
    )
    everything = choose([*ALL, packed_rgb, png, rvl])
    assert (everything[Role.RGB], everything[Role.DEPTH]) == (RGB.name, DEPTH.name)
    packed_alone = choose([POSE, INFO, packed_rgb, png, rvl])
    assert (packed_alone[Role.RGB], packed_alone[Role.DEPTH]) == (packed_rgb.name, rvl.name)
    named = choose([*ALL, packed_rgb], rgb=packed_rgb.name)
    assert named[Role.RGB] == packed_rgb.name


@pytest.mark.parametrize(
    ("name", "kind", "encoding"),
    [
        ("/cam/x/compressed", COMPRESSED_IMAGE, "16UC1; png compressed "),
        ("/cam/depth/compressed", COMPRESSED_IMAGE, "mono16; png compressed "),
        ("/cam/depth/image_raw", IMAGE, "mono16"),
    ],
)
def test_16_bit_depth_is_found_by_format_or_by_its_topics_name(name, kind, encoding):
    candidates = [OTHER, POSE, INFO, RGB, CandidateTopic(name, kind, encoding)]
    assert choose(candidates)[Role.DEPTH] == name


def test_16_bit_infrared_is_no_depth():
    infrared = CandidateTopic("/cam/infra/image", IMAGE, "mono16")
    assert choose([*ALL, infrared])[Role.DEPTH] == DEPTH.name


@pytest.mark.parametrize("encoding", ["bayer_grbg8", "yuv422", "yuv422_yuy2"])
def test_raw_sensor_colours_are_colour(encoding):
    raw = CandidateTopic("/cam/image_raw", IMAGE, encoding)
    assert choose([*ALL[:-1], raw])[Role.RGB] == raw.name
