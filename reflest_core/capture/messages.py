# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sensor messages as plain data: the ROS node and the bag readers both fill these."""

from __future__ import annotations

import array
import enum
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

ByteData: TypeAlias = "bytes | bytearray | memoryview | array.array[int] | NDArray[np.uint8]"


def plain_frame(name: str) -> str:
    """Return a frame's name without the leading slash of ROS 1.

    Args:
        name: As a message gives it.
    """
    return name.removeprefix("/")


class Role(enum.Enum):
    """What a topic is used for; the value is its relative topic name in the node."""

    RGB = "rgb"
    DEPTH = "depth"
    CAMERA_INFO = "camera_info"
    POSE = "pose"
    MASK = "mask"
    DEPTH_INFO = "depth_camera_info"
    TF = "tf"
    TF_STATIC = "tf_static"


@dataclass(frozen=True, eq=False)
class ImageMessage:
    """``sensor_msgs/Image``.

    Attributes:
        stamp_ns: Nanoseconds.
        frame_id: The camera's frame.
        height: Rows.
        width: Columns.
        encoding: As ``rgb8``.
        is_bigendian: Byte order of wider pixels.
        step: Bytes in a row.
        data: ``height`` rows of ``step`` bytes.
    """

    stamp_ns: int
    frame_id: str
    height: int
    width: int
    encoding: str
    is_bigendian: bool
    step: int
    data: ByteData


@dataclass(frozen=True, eq=False)
class CompressedImageMessage:
    """``sensor_msgs/CompressedImage``: a jpeg, a png, or a png behind compressedDepth's header.

    Attributes:
        stamp_ns: Nanoseconds.
        frame_id: The camera's frame.
        format: As ``jpeg`` or ``16UC1; compressedDepth png``.
        data: The packed image.
    """

    stamp_ns: int
    frame_id: str
    format: str
    data: ByteData


@dataclass(frozen=True)
class CameraInfoMessage:
    """``sensor_msgs/CameraInfo``: calibration at full resolution, then ROI and binning.

    Attributes:
        stamp_ns: Nanoseconds.
        frame_id: The camera's frame.
        width: Columns at full resolution.
        height: Rows at full resolution.
        k: (9,) row-major raw intrinsics, pixels.
        d: Distortion coefficients of ``distortion_model``.
        distortion_model: As ``plumb_bob``.
        p: (12,) row-major projection of the rectified image.
        binning: x, y; 0 means 1.
        roi: x offset, y offset, width, height in full-resolution pixels; all 0 means the whole.
    """

    stamp_ns: int
    frame_id: str
    width: int
    height: int
    k: tuple[float, ...]
    d: tuple[float, ...] = ()
    distortion_model: str = ""
    p: tuple[float, ...] = ()
    binning: tuple[int, int] = (0, 0)
    roi: tuple[int, int, int, int] = (0, 0, 0, 0)


@dataclass(frozen=True)
class PoseMessage:
    """Pose of ``child_frame_id`` in ``frame_id`` (``PoseStamped``, ``Odometry``, a transform).

    Attributes:
        stamp_ns: Nanoseconds.
        frame_id: The parent frame.
        position: x, y, z in metres.
        orientation: Quaternion x, y, z, w.
        child_frame_id: Empty for the colour camera's optical frame, as in a ``PoseStamped``.
    """

    stamp_ns: int
    frame_id: str
    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]
    child_frame_id: str = ""


@dataclass(frozen=True)
class TransformsMessage:
    """``tf2_msgs/TFMessage``.

    Attributes:
        transforms: Each is the pose of its child frame in its parent frame.
    """

    transforms: tuple[PoseMessage, ...]

    @property
    def stamp_ns(self) -> int:
        """The latest stamp in it; 0 where it is empty."""
        return max((transform.stamp_ns for transform in self.transforms), default=0)


AnyImage: TypeAlias = ImageMessage | CompressedImageMessage
SensorMessage: TypeAlias = AnyImage | CameraInfoMessage | PoseMessage | TransformsMessage


@dataclass(frozen=True, eq=False)
class Match:
    """The messages of one moment.

    Attributes:
        rgb: The colour image.
        depth: The depth image nearest to it.
        camera_info: Calibration of the colour camera.
        depth_info: Calibration of the depth camera, if known.
        pose_before: The pose at or before the colour image's stamp.
        pose_after: The pose at or after it.
        mask: The mask nearest to it, if one is used.
    """

    rgb: AnyImage
    depth: AnyImage
    camera_info: CameraInfoMessage
    depth_info: CameraInfoMessage | None
    pose_before: PoseMessage
    pose_after: PoseMessage
    mask: AnyImage | None
