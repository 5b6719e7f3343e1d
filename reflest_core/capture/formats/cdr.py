# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""CDR bytes to messages, for the six ROS 2 message types that a capture needs.

Their layouts are the same in every ROS 2 distribution so far, so no definition is read from the
bag.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

from reflest_core.capture.messages import (
    CameraInfoMessage,
    CompressedImageMessage,
    ImageMessage,
    PoseMessage,
    SensorMessage,
    TransformsMessage,
)
from reflest_core.capture.refusal import FrameRefused, RefusalCause

IMAGE = "sensor_msgs/msg/Image"
COMPRESSED_IMAGE = "sensor_msgs/msg/CompressedImage"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
POSE_STAMPED = "geometry_msgs/msg/PoseStamped"
ODOMETRY = "nav_msgs/msg/Odometry"
TRANSFORMS = "tf2_msgs/msg/TFMessage"


def read_message(message_type: str, cdr: bytes, topic: str) -> SensorMessage:
    """Return the message in ``cdr``.

    Args:
        message_type: its ROS type.
        cdr: the serialised message.
        topic: how sentences name the stream.

    Raises:
        FrameRefused: ENCODING, where the type is none of the six: a topic's channels may have
            different types. TRUNCATED, where the bytes end early or make no sense.
    """
    from rosbags.serde import SerdeError

    if message_type not in READERS:
        raise FrameRefused(
            RefusalCause.ENCODING,
            f"a message on {topic} is a {message_type[:100]}, which is not read",
        )
    try:
        message = _typestore().deserialize_cdr(cdr, message_type)
    except (SerdeError, UnicodeDecodeError) as error:
        raise FrameRefused(
            RefusalCause.TRUNCATED,
            f"a {message_type} of {len(cdr)} bytes on {topic} cannot be read: {error}",
        ) from error
    return READERS[message_type](message)


@functools.cache
def _typestore() -> Any:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def _stamp_ns(message: Any) -> int:
    return int(message.header.stamp.sec) * 10**9 + int(message.header.stamp.nanosec)


def _image(message: Any) -> ImageMessage:
    return ImageMessage(
        stamp_ns=_stamp_ns(message),
        frame_id=message.header.frame_id,
        height=int(message.height),
        width=int(message.width),
        encoding=message.encoding,
        is_bigendian=bool(message.is_bigendian),
        step=int(message.step),
        data=message.data,
    )


def _compressed_image(message: Any) -> CompressedImageMessage:
    return CompressedImageMessage(
        _stamp_ns(message), message.header.frame_id, message.format, message.data
    )


def _camera_info(message: Any) -> CameraInfoMessage:
    roi = message.roi
    return CameraInfoMessage(
        stamp_ns=_stamp_ns(message),
        frame_id=message.header.frame_id,
        width=int(message.width),
        height=int(message.height),
        k=tuple(float(value) for value in message.k),
        d=tuple(float(value) for value in message.d),
        distortion_model=message.distortion_model,
        p=tuple(float(value) for value in message.p),
        binning=(int(message.binning_x), int(message.binning_y)),
        roi=(int(roi.x_offset), int(roi.y_offset), int(roi.width), int(roi.height)),
    )


def _posed(message: Any, child_frame_id: str, position: Any, orientation: Any) -> PoseMessage:
    return PoseMessage(
        stamp_ns=_stamp_ns(message),
        frame_id=message.header.frame_id,
        position=(position.x, position.y, position.z),
        orientation=(orientation.x, orientation.y, orientation.z, orientation.w),
        child_frame_id=child_frame_id,
    )


def _pose(message: Any, pose: Any, child_frame_id: str) -> PoseMessage:
    return _posed(message, child_frame_id, pose.position, pose.orientation)


def _transforms(message: Any) -> TransformsMessage:
    return TransformsMessage(
        tuple(
            _posed(one, one.child_frame_id, one.transform.translation, one.transform.rotation)
            for one in message.transforms
        )
    )


READERS: dict[str, Callable[[Any], SensorMessage]] = {
    IMAGE: _image,
    COMPRESSED_IMAGE: _compressed_image,
    CAMERA_INFO: _camera_info,
    POSE_STAMPED: lambda message: _pose(message, message.pose, ""),
    ODOMETRY: lambda message: _pose(message, message.pose.pose, message.child_frame_id),
    TRANSFORMS: _transforms,
}
