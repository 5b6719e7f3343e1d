"""ROS messages as the plain data that reflest_core takes; image bytes are not copied."""

from __future__ import annotations

from typing import Protocol

from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import CameraInfo, Image

from reflest_core.capture.messages import CameraInfoMessage, ImageMessage, PoseMessage


class Stamp(Protocol):
    """``builtin_interfaces/Time``."""

    sec: int
    nanosec: int


def stamp_to_ns(stamp: Stamp) -> int:
    """Nanoseconds of a stamp."""
    return stamp.sec * 1_000_000_000 + stamp.nanosec


def image_message(message: Image) -> ImageMessage:
    """``sensor_msgs/Image`` as plain data."""
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
    """``sensor_msgs/CameraInfo`` as plain data."""
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


def pose_message(message: PoseStamped) -> PoseMessage:
    """``geometry_msgs/PoseStamped`` as plain data."""
    position, orientation = message.pose.position, message.pose.orientation
    return PoseMessage(
        stamp_ns=stamp_to_ns(message.header.stamp),
        frame_id=message.header.frame_id,
        position=(position.x, position.y, position.z),
        orientation=(orientation.x, orientation.y, orientation.z, orientation.w),
    )
