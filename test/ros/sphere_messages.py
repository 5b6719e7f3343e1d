# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The sphere scene as ROS messages, and as a bag."""

from __future__ import annotations

import array
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from scipy.spatial.transform import Rotation
from sensor_msgs.msg import CameraInfo, Image
from sphere_scene import FOCAL, HEIGHT, WIDTH, View, views
from std_msgs.msg import Header

RGB = "/camera/color/image_raw"
DEPTH = "/camera/aligned_depth_to_color/image_raw"
CAMERA_INFO = "/camera/color/camera_info"
POSE = "/camera/pose"
OPTICAL_FRAME = "camera_color_optical_frame"


def header(stamp_ns: int, frame_id: str = OPTICAL_FRAME) -> Header:
    return Header(stamp=Time(sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9), frame_id=frame_id)


def rgb_message(view: View, encoding: str = "rgb8") -> Image:
    return image(view.stamp_ns, encoding, view.rgb, 3 * WIDTH)


def depth_message(view: View, encoding: str = "16UC1") -> Image:
    if encoding == "16UC1":
        return image(view.stamp_ns, encoding, np.round(view.depth * 1000).astype("<u2"), 2 * WIDTH)
    return image(view.stamp_ns, encoding, view.depth.astype("<f4"), 4 * WIDTH)


def image(stamp_ns: int, encoding: str, pixels: np.ndarray, step: int) -> Image:
    message = Image(
        header=header(stamp_ns), height=HEIGHT, width=WIDTH, encoding=encoding, step=step
    )
    message.data = array.array("B", pixels.tobytes())
    return message


def camera_info_message(view: View) -> CameraInfo:
    k = [FOCAL, 0.0, WIDTH / 2, 0.0, FOCAL, HEIGHT / 2, 0.0, 0.0, 1.0]
    return CameraInfo(
        header=header(view.stamp_ns),
        width=WIDTH,
        height=HEIGHT,
        distortion_model="plumb_bob",
        d=[0.0] * 5,
        k=k,
        r=np.eye(3).ravel().tolist(),
        p=[FOCAL, 0.0, WIDTH / 2, 0.0, 0.0, FOCAL, HEIGHT / 2, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def pose_message(view: View) -> PoseStamped:
    message = PoseStamped(header=header(view.stamp_ns, "world"))
    position, orientation = message.pose.position, message.pose.orientation
    position.x, position.y, position.z = view.T_world_camera[:3, 3].tolist()
    quaternion = Rotation.from_matrix(view.T_world_camera[:3, :3]).as_quat()
    orientation.x, orientation.y, orientation.z, orientation.w = quaternion.tolist()
    return message


def messages_of(view: View, depth_encoding: str = "16UC1") -> Iterator[tuple[str, object]]:
    yield POSE, pose_message(view)
    yield CAMERA_INFO, camera_info_message(view)
    yield DEPTH, depth_message(view, depth_encoding)
    yield RGB, rgb_message(view)


def write_bag(path: Path, stamped: Iterable[tuple[int, str, object]]) -> Path:
    """Write ``(log_time_ns, topic, message)`` to a rosbag2 directory with one MCAP file."""
    typestore = get_typestore(Stores.ROS2_JAZZY)
    connections = {}
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for log_time_ns, topic, message in stamped:
            if topic not in connections:
                kind = "/msg/".join(type(message).__module__.split(".msg.")[0:1])
                name = f"{kind}/msg/{type(message).__name__}"
                connections[topic] = writer.add_connection(topic, name, typestore=typestore)
            writer.write(connections[topic], log_time_ns, serialize_message(message))
    return path


def write_sphere_bag(path: Path, count: int = 24, depth_encoding: str = "16UC1") -> Path:
    return write_bag(
        path,
        (
            (view.stamp_ns, topic, message)
            for view in views(count)
            for topic, message in messages_of(view, depth_encoding)
        ),
    )
