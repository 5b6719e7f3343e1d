# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A short recording of a sphere on a plane, as messages, and writers for every kind of capture."""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from reflest_core.capture.messages import (
    CameraInfoMessage,
    CompressedImageMessage,
    ImageMessage,
    PoseMessage,
    Role,
    TransformsMessage,
)

WIDTH, HEIGHT, FOCAL = 96, 72, 100.0
K = (FOCAL, 0.0, WIDTH / 2, 0.0, FOCAL, HEIGHT / 2, 0.0, 0.0, 1.0)
START_NS, PERIOD_NS = 5 * 10**9, 10**9 // 30
TOPICS = {
    Role.RGB: "/camera/color/image_raw",
    Role.DEPTH: "/camera/aligned_depth_to_color/image_raw",
    Role.CAMERA_INFO: "/camera/color/camera_info",
    Role.POSE: "/camera/pose",
}
STORE = get_typestore(Stores.ROS2_JAZZY)


@dataclass(frozen=True)
class Recorded:
    role: Role
    message: object


def stamp(index):
    return START_NS + index * PERIOD_NS


def camera_pose(index):
    """Camera-to-world of frame ``index``: on an arc 0.6 m around the origin, looking at it."""
    angle = 0.06 * index
    centre = 0.6 * np.array([math.sin(angle), 0.0, math.cos(angle)])
    forward = -centre / np.linalg.norm(centre)
    down = np.array([0.0, -1.0, 0.0])
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1] = np.cross(down, forward), down
    pose[:3, 2], pose[:3, 3] = forward, centre
    return pose


def depth_of(index, radius=0.15):
    """Z in metres of a sphere about the origin before the plane z = -0.1; 0 where neither."""
    pose = camera_pose(index)
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    rays = np.stack(
        [(columns - WIDTH / 2) / FOCAL, (rows - HEIGHT / 2) / FOCAL, np.ones_like(rows)], axis=-1
    )
    directions, centre = rays @ pose[:3, :3].T, pose[:3, 3]
    squared = (directions**2).sum(-1)
    along = directions @ centre
    discriminant = along**2 - squared * (centre @ centre - radius**2)
    sphere = (-along - np.sqrt(np.maximum(discriminant, 0.0))) / squared
    plane = np.divide(
        -0.1 - centre[2],
        directions[..., 2],
        where=directions[..., 2] < -1e-6,
        out=np.zeros_like(along),
    )
    return np.where(discriminant > 0, sphere, plane)


def colour_of(index):
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    return np.stack(
        [120 + columns % 50, 80 + rows % 40, np.full_like(rows, 60 + index)], axis=-1
    ).astype(np.uint8)


def image(pixels, encoding, stamp_ns, frame_id="camera_color_optical_frame"):
    pixels = np.ascontiguousarray(pixels)
    height, width = pixels.shape[:2]
    return ImageMessage(
        stamp_ns,
        frame_id,
        height,
        width,
        encoding,
        False,
        pixels.nbytes // height,
        pixels.tobytes(),
    )


def rgb_message(index):
    return image(colour_of(index), "rgb8", stamp(index))


def depth_message(index):
    millimetres = np.round(depth_of(index) * 1000).astype("<u2")
    return image(millimetres, "16UC1", stamp(index))


def info_message(index):
    return CameraInfoMessage(stamp(index), "camera_color_optical_frame", WIDTH, HEIGHT, K)


def pose_message(index):
    angle = 0.06 * index
    x, y, z = camera_pose(index)[:3, 3].tolist()
    # A turn by pi about x (to look down), after one by the arc's angle about y.
    return PoseMessage(
        stamp(index), "world", (x, y, z), (math.cos(angle / 2), 0.0, -math.sin(angle / 2), 0.0)
    )


def recording(count=12):
    """Messages in recorded order."""
    makers = (
        (Role.CAMERA_INFO, info_message),
        (Role.POSE, pose_message),
        (Role.RGB, rgb_message),
        (Role.DEPTH, depth_message),
    )
    return [Recorded(role, make(index)) for index in range(count) for role, make in makers]


def changed(messages, role, index, **fields):
    """The recording with fields of the ``index``-th message of ``role`` replaced."""
    of_role = [recorded for recorded in messages if recorded.role is role]
    target = of_role[index]
    return [
        Recorded(role, replace(recorded.message, **fields)) if recorded is target else recorded
        for recorded in messages
    ]


def write_bag(
    folder: Path,
    messages,
    storage="mcap",
    topics=TOPICS,
    log_offset=lambda role: 0,
    compression=CompressionMode.NONE,
):
    """Write a rosbag2 directory; return its one data file."""
    writer = Writer(folder, version=9, storage_plugin=StoragePlugin[storage.upper()])
    writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        connections = {}
        for recorded in messages:
            message_type, message = _as_ros(recorded.message)
            key = (topics[recorded.role], message_type)
            if key not in connections:
                connections[key] = writer.add_connection(*key, typestore=STORE)
            log_time = recorded.message.stamp_ns + log_offset(recorded.role)
            writer.write(connections[key], log_time, STORE.serialize_cdr(message, message_type))
    return next(path for path in folder.iterdir() if path.name != "metadata.yaml")


def _ros(name, **fields):
    return STORE.types[name](**fields)


def _header(message):
    seconds, nanoseconds = divmod(message.stamp_ns, 10**9)
    time = _ros("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds)
    return _ros("std_msgs/msg/Header", stamp=time, frame_id=message.frame_id)


def _as_ros(message):
    if isinstance(message, ImageMessage):
        kind = "sensor_msgs/msg/Image"
        return kind, _ros(
            kind,
            header=_header(message),
            height=message.height,
            width=message.width,
            encoding=message.encoding,
            is_bigendian=int(message.is_bigendian),
            step=message.step,
            data=np.frombuffer(message.data, np.uint8),
        )
    if isinstance(message, CompressedImageMessage):
        kind = "sensor_msgs/msg/CompressedImage"
        data = np.frombuffer(message.data, np.uint8)
        return kind, _ros(kind, header=_header(message), format=message.format, data=data)
    if isinstance(message, CameraInfoMessage):
        return _ros_camera_info(message)
    if isinstance(message, TransformsMessage):
        kind = "tf2_msgs/msg/TFMessage"
        return kind, _ros(kind, transforms=[_ros_transform(one) for one in message.transforms])
    x, y, z = message.position
    qx, qy, qz, qw = message.orientation
    pose = _ros(
        "geometry_msgs/msg/Pose",
        position=_ros("geometry_msgs/msg/Point", x=x, y=y, z=z),
        orientation=_ros("geometry_msgs/msg/Quaternion", x=qx, y=qy, z=qz, w=qw),
    )
    if not message.child_frame_id:
        kind = "geometry_msgs/msg/PoseStamped"
        return kind, _ros(kind, header=_header(message), pose=pose)
    return _ros_odometry(message, pose)


def _ros_camera_info(message):
    kind = "sensor_msgs/msg/CameraInfo"
    left, top, width, height = message.roi
    roi = _ros(
        "sensor_msgs/msg/RegionOfInterest",
        x_offset=left,
        y_offset=top,
        height=height,
        width=width,
        do_rectify=False,
    )
    return kind, _ros(
        kind,
        header=_header(message),
        height=message.height,
        width=message.width,
        distortion_model=message.distortion_model,
        d=np.array(message.d, dtype=np.float64),
        k=np.array(message.k),
        r=np.eye(3).ravel(),
        p=np.array(message.p or [0.0] * 12),
        binning_x=message.binning[0],
        binning_y=message.binning[1],
        roi=roi,
    )


def _ros_transform(message):
    x, y, z = message.position
    qx, qy, qz, qw = message.orientation
    return _ros(
        "geometry_msgs/msg/TransformStamped",
        header=_header(message),
        child_frame_id=message.child_frame_id,
        transform=_ros(
            "geometry_msgs/msg/Transform",
            translation=_ros("geometry_msgs/msg/Vector3", x=x, y=y, z=z),
            rotation=_ros("geometry_msgs/msg/Quaternion", x=qx, y=qy, z=qz, w=qw),
        ),
    )


def _ros_odometry(message, pose):
    kind = "nav_msgs/msg/Odometry"
    zero = _ros("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
    covariance = np.zeros(36)
    return kind, _ros(
        kind,
        header=_header(message),
        child_frame_id=message.child_frame_id,
        pose=_ros("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=covariance),
        twist=_ros(
            "geometry_msgs/msg/TwistWithCovariance",
            covariance=covariance,
            twist=_ros("geometry_msgs/msg/Twist", linear=zero, angular=zero),
        ),
    )


def write_seven_scenes(folder: Path, count=6):
    """Write a 7-Scenes folder with png colour, and its intrinsics file."""
    folder.mkdir()
    np.savetxt(folder / "camera-intrinsics.txt", np.reshape(K, (3, 3)))
    for index in range(count):
        stem = folder / f"frame-{index:06d}"
        cv2.imwrite(f"{stem}.color.png", colour_of(index)[:, :, ::-1])
        millimetres = np.round(depth_of(index) * 1000).astype(np.uint16)
        millimetres[millimetres == 0] = 65535
        cv2.imwrite(f"{stem}.depth.png", millimetres)
        np.savetxt(f"{stem}.pose.txt", camera_pose(index))


def write_tum(folder: Path, count=6):
    """Write a TUM folder: depth 3 ms after colour, poses at 100 Hz."""
    for name in ("rgb", "depth"):
        (folder / name).mkdir(parents=True)
    lines = {"rgb": ["# colour"], "depth": ["# depth"]}
    for index in range(count):
        colour_time, depth_time = 1000 + index / 30, 1000.003 + index / 30
        cv2.imwrite(str(folder / f"rgb/{index}.png"), colour_of(index)[:, :, ::-1])
        units = np.round(depth_of(index) * 5000).astype(np.uint16)
        cv2.imwrite(str(folder / f"depth/{index}.png"), units)
        lines["rgb"].append(f"{colour_time:.6f} rgb/{index}.png")
        lines["depth"].append(f"{depth_time:.6f} depth/{index}.png")
    poses = ["# timestamp tx ty tz qx qy qz qw"]
    for step in range(-1, 100):
        angle = 0.06 * 30 * step / 100
        x, z = 0.6 * math.sin(angle), 0.6 * math.cos(angle)
        qx, qz = math.cos(angle / 2), -math.sin(angle / 2)
        poses.append(f"{1000 + step / 100:.4f} {x} 0 {z} {qx} 0 {qz} 0")
    np.savetxt(folder / "camera-intrinsics.txt", np.reshape(K, (3, 3)))
    for name in ("rgb", "depth"):
        (folder / f"{name}.txt").write_text("\n".join(lines[name]))
    (folder / "groundtruth.txt").write_text("\n".join(poses))
