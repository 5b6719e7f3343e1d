# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Poses from /tf across processes, and depth that is registered with /tf_static."""

from __future__ import annotations

import dataclasses
import importlib.util

import pytest
from feed import SOON
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from scipy.spatial.transform import Rotation
from sphere_messages import CAMERA_INFO, DEPTH, OPTICAL_FRAME, RGB, messages_of
from sphere_scene import views
from tf2_interface import tf2_environment

STORE = get_typestore(Stores.ROS2_JAZZY)
COUNT = 8
DEPTH_FRAME = "camera_depth_optical_frame"
DEPTH_INFO = "/camera/depth/camera_info"
BY_TF = ("-p", "capture.pose_source:=tf", "-p", "capture.world_frame:=map")


@pytest.fixture(scope="module")
def tf2(tmp_path_factory):
    return tf2_environment(tmp_path_factory.mktemp("tf2_msgs"))


def transform(stamp_ns, parent, child, translation=(0.0,) * 3, rotation=(0.0, 0.0, 0.0, 1.0)):
    """A TFMessage in CDR, made without tf2_msgs."""

    def made(name, **fields):
        return STORE.types[name](**fields)

    stamp = made("builtin_interfaces/msg/Time", sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
    x, y, z = map(float, translation)
    qx, qy, qz, qw = map(float, rotation)
    one = made(
        "geometry_msgs/msg/TransformStamped",
        header=made("std_msgs/msg/Header", stamp=stamp, frame_id=parent),
        child_frame_id=child,
        transform=made(
            "geometry_msgs/msg/Transform",
            translation=made("geometry_msgs/msg/Vector3", x=x, y=y, z=z),
            rotation=made("geometry_msgs/msg/Quaternion", x=qx, y=qy, z=qz, w=qw),
        ),
    )
    kind = "tf2_msgs/msg/TFMessage"
    return kind, bytes(STORE.serialize_cdr(made(kind, transforms=[one]), kind))


def messages(some, has_tf, is_registered):
    """(stamp, topic, type, CDR) of views whose poses are transforms of the base."""
    first = some[0].stamp_ns
    if has_tf:
        yield first, "/tf_static", *transform(first, "base", OPTICAL_FRAME, (0.1, 0.0, 0.0))
    if not is_registered:
        yield first, "/tf_static", *transform(first, OPTICAL_FRAME, DEPTH_FRAME)
    for view in some:
        if has_tf:
            pose = view.T_world_camera.copy()
            pose[:3, 3] -= 0.1 * pose[:3, 0]  # the base stands 10 cm to the camera's left
            rotation = Rotation.from_matrix(pose[:3, :3]).as_quat()
            yield (
                view.stamp_ns,
                "/tf",
                *transform(view.stamp_ns, "map", "base", pose[:3, 3], rotation),
            )
        for topic, message in messages_of(view):
            kind = f"{type(message).__module__.split('.')[0]}/msg/{type(message).__name__}"
            if topic == DEPTH and not is_registered:
                message.header.frame_id = DEPTH_FRAME
            if topic in (RGB, DEPTH, CAMERA_INFO) or not has_tf:
                yield view.stamp_ns, topic, kind, serialize_message(message)
            if topic == CAMERA_INFO and not is_registered:
                message.header.frame_id = DEPTH_FRAME
                yield view.stamp_ns, DEPTH_INFO, kind, serialize_message(message)


def write(path, has_tf=True, is_registered=True, ahead_ns=0):
    some = [dataclasses.replace(v, stamp_ns=v.stamp_ns + ahead_ns) for v in views(COUNT)]
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connections = {}
        for stamp_ns, topic, kind, cdr in messages(some, has_tf, is_registered):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(connections[topic], stamp_ns, cdr)
    return path


def started(start, settings_file, tf2, *arguments):
    node = start(
        "reflest_ros.estimator", "--ros-args", "--params-file", settings_file, *arguments, **tf2
    )
    node.wait_for_line("listening to", 600.0)
    return node


def played(start, bag, tf2, *arguments):
    player = start("reflest_ros.bag_player", bag, *arguments, **tf2)
    assert player.exit_code() == 0, player.output


def test_poses_come_from_tf_and_what_lacks_is_named(start, settings_file, peer, tf2, tmp_path):
    node = started(start, settings_file, tf2, *BY_TF)
    bag = write(tmp_path / "bag")
    images = (RGB, DEPTH, CAMERA_INFO)
    played(start, bag, tf2, "--topics", *images)
    peer.wait_until(lambda: peer.count("refused transform_missing") == COUNT, "not refused", SOON)
    warning = node.wait_for_line(r"\(cause: transform_missing; logged once\)")
    for word in ("map", OPTICAL_FRAME, "tf holds nothing yet"):
        assert word in warning
    assert peer.count("frames fused") == 0
    played(start, write(tmp_path / "good", ahead_ns=10**9), tf2)
    peer.wait_for_count("frames fused", COUNT)
    node.interrupt()
    assert node.exit_code() == 0, node.output
    assert "Traceback" not in node.output


def test_depth_is_registered_with_what_tf_static_says(start, settings_file, peer, tf2, tmp_path):
    node = started(start, settings_file, tf2)
    played(start, write(tmp_path / "bag", has_tf=False, is_registered=False), tf2)
    peer.wait_for_count("frames fused", COUNT)
    assert not [key for key in peer.diagnostics if key.startswith("refused")]
    node.interrupt()
    assert node.exit_code() == 0, node.output


@pytest.mark.skipif(
    importlib.util.find_spec("tf2_msgs") is not None, reason="tf2_msgs is installed"
)
def test_without_tf2_msgs_a_node_that_needs_it_says_so(start):
    node = start("reflest_ros.estimator", "--ros-args", *BY_TF)
    assert node.exit_code(600.0) == 2
    assert "the package tf2_msgs is not installed" in node.output
    assert "Traceback" not in node.output
