# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Converts ROS messages to the plain data that reflest_core takes; images are not copied."""

from __future__ import annotations

from typing import Any, Protocol

from builtin_interfaces.msg import Time
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Header

from reflest_core.capture.messages import (
    CameraInfoMessage,
    CompressedImageMessage,
    ImageMessage,
    PoseMessage,
    TransformsMessage,
)


class Stamp(Protocol):
    """``builtin_interfaces/Time``."""

    sec: int
    nanosec: int


def stamp_to_ns(stamp: Stamp) -> int:
    """Convert a stamp of ROS.

    Args:
        stamp: A ``builtin_interfaces/Time``.

    Returns:
        Nanoseconds since the epoch.
    """
    return stamp.sec * 1_000_000_000 + stamp.nanosec


def ns_to_stamp(stamp_ns: int) -> Time:
    """Convert to a stamp of ROS.

    Args:
        stamp_ns: Nanoseconds since the epoch.

    Returns:
        A ``builtin_interfaces/Time``.
    """
    seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
    return Time(sec=seconds, nanosec=nanoseconds)


def image_message(message: Image) -> ImageMessage:
    """Convert an image.

    Args:
        message: A ``sensor_msgs/Image``.

    Returns:
        The image; it shares the bytes of ``message``.
    """
    return ImageMessage(
        stamp_ns=stamp_to_ns(message.header.stamp),
        frame_id=message.header.frame_id,
        height=message.height,
        width=message.width,
        encoding=message.encoding,
        is_bigendian=bool(message.is_bigendian),
        step=message.step,
        data=message.data,
    )


def camera_info_message(message: CameraInfo) -> CameraInfoMessage:
    """Convert a calibration.

    Args:
        message: A ``sensor_msgs/CameraInfo``.

    Returns:
        The calibration.
    """
    roi = message.roi
    return CameraInfoMessage(
        stamp_ns=stamp_to_ns(message.header.stamp),
        frame_id=message.header.frame_id,
        width=message.width,
        height=message.height,
        k=tuple(float(value) for value in message.k),
        d=tuple(float(value) for value in message.d),
        distortion_model=message.distortion_model,
        p=tuple(float(value) for value in message.p),
        binning=(message.binning_x, message.binning_y),
        roi=(roi.x_offset, roi.y_offset, roi.width, roi.height),
    )


def compressed_image_message(message: CompressedImage) -> CompressedImageMessage:
    """Convert a compressed image.

    Args:
        message: A ``sensor_msgs/CompressedImage``.

    Returns:
        The image; it shares the bytes of ``message``.
    """
    return CompressedImageMessage(
        stamp_ns=stamp_to_ns(message.header.stamp),
        frame_id=message.header.frame_id,
        format=message.format,
        data=message.data,
    )


def pose_message(message: PoseStamped) -> PoseMessage:
    """Convert a pose.

    Args:
        message: A ``geometry_msgs/PoseStamped``.

    Returns:
        The pose, not checked.
    """
    return _posed(message.header, "", message.pose.position, message.pose.orientation)


def odometry_message(message: Odometry) -> PoseMessage:
    """Convert the pose of an odometry.

    Args:
        message: A ``nav_msgs/Odometry``.

    Returns:
        The pose, not checked.
    """
    pose = message.pose.pose
    return _posed(message.header, message.child_frame_id, pose.position, pose.orientation)


def transforms_message(message: Any) -> TransformsMessage:
    """Convert transforms.

    Args:
        message: A ``tf2_msgs/TFMessage``.

    Returns:
        The transforms, not checked.
    """
    return TransformsMessage(
        tuple(
            _posed(
                one.header, one.child_frame_id, one.transform.translation, one.transform.rotation
            )
            for one in message.transforms
        )
    )


def _posed(header: Header, child: str, position: Any, orientation: Any) -> PoseMessage:
    return PoseMessage(
        stamp_ns=stamp_to_ns(header.stamp),
        frame_id=header.frame_id,
        position=(position.x, position.y, position.z),
        orientation=(orientation.x, orientation.y, orientation.z, orientation.w),
        child_frame_id=child,
    )
