# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Writes an RGB-D sequence as a rosbag2 directory with one MCAP file."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import zstandard
from numpy.typing import NDArray
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from scipy.spatial.transform import Rotation

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.formats.cdr import CAMERA_INFO, IMAGE, POSE_STAMPED

CAMERA_FRAME, WORLD_FRAME = "camera_color_optical_frame", "map"
RGB, DEPTH = "/camera/color/image_raw", "/camera/aligned_depth_to_color/image_raw"
INFO, POSE = "/camera/color/camera_info", "/camera/pose"
TOPIC_TYPES = {RGB: IMAGE, DEPTH: IMAGE, INFO: CAMERA_INFO, POSE: POSE_STAMPED}
ZSTD_LEVEL = 19


@dataclass(frozen=True)
class RecordedFrame:
    """A frame of a recording.

    Attributes:
        stamp_ns: Nanoseconds.
        rgb: (H, W, 3) uint8 sRGB.
        depth_mm: (H, W) uint16, millimetres, 0 where unknown.
        pose: (4, 4) ``T_world_camera``.
    """

    stamp_ns: int
    rgb: NDArray[np.uint8]
    depth_mm: NDArray[np.uint16]
    pose: NDArray[np.float64]


def write_bag(
    path: Path,
    camera: CameraIntrinsics,
    frames: Iterable[RecordedFrame],
    is_compressed: bool = True,
) -> None:
    """Write a rosbag2 folder of an MCAP file; the four messages of a frame share a stamp.

    ``rgb8``, ``16UC1`` in millimetres, a pinhole ``CameraInfo`` and the pose of the camera's
    optical frame in ``map``. Equal frames give equal bytes.

    Args:
        path: the folder, which must not exist.
        camera: intrinsics.
        frames: images with poses, in order.
        is_compressed: whether the file's chunks are compressed, which is slow.
    """
    store = get_typestore(Stores.ROS2_JAZZY)
    writer = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP)
    if is_compressed:
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        if is_compressed:
            _compress_hard(writer)
        topics = {
            topic: writer.add_connection(topic, name, typestore=store)
            for topic, name in TOPIC_TYPES.items()
        }
        for frame in frames:
            for topic, message in _messages(store.types, camera, frame).items():
                data = store.serialize_cdr(message, TOPIC_TYPES[topic])
                writer.write(topics[topic], frame.stamp_ns, data)


def _compress_hard(writer: Any) -> None:
    """Replace the writer's fast default level: bags are written once and carried about."""
    writer.storage.compressor = zstandard.ZstdCompressor(level=ZSTD_LEVEL).compress


def _messages(types: Any, camera: CameraIntrinsics, frame: RecordedFrame) -> dict[str, Any]:
    stamp = types["builtin_interfaces/msg/Time"](
        sec=frame.stamp_ns // 10**9, nanosec=frame.stamp_ns % 10**9
    )
    in_camera = types["std_msgs/msg/Header"](stamp=stamp, frame_id=CAMERA_FRAME)
    in_world = types["std_msgs/msg/Header"](stamp=stamp, frame_id=WORLD_FRAME)
    # The pose and calibration go first, so that a frame is complete with its images.
    return {
        INFO: _camera_info(types, in_camera, camera),
        POSE: _pose(types, in_world, frame.pose),
        RGB: _image(types, in_camera, frame.rgb, "rgb8"),
        DEPTH: _image(types, in_camera, frame.depth_mm.astype("<u2"), "16UC1"),
    }


def _image(types: Any, header: Any, pixels: NDArray[Any], encoding: str) -> Any:
    height, width = pixels.shape[:2]
    data = np.frombuffer(np.ascontiguousarray(pixels).tobytes(), np.uint8)
    return types[IMAGE](
        header=header,
        height=height,
        width=width,
        encoding=encoding,
        is_bigendian=0,
        step=len(data) // height,
        data=data,
    )


def _camera_info(types: Any, header: Any, camera: CameraIntrinsics) -> Any:
    matrix = camera.matrix
    return types[CAMERA_INFO](
        header=header,
        height=camera.height,
        width=camera.width,
        distortion_model="plumb_bob",
        d=np.zeros(5),
        k=matrix.reshape(-1),
        r=np.eye(3).reshape(-1),
        p=np.column_stack([matrix, np.zeros(3)]).reshape(-1),
        binning_x=0,
        binning_y=0,
        roi=types["sensor_msgs/msg/RegionOfInterest"](
            x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        ),
    )


def _pose(types: Any, header: Any, pose: NDArray[np.float64]) -> Any:
    x, y, z, w = Rotation.from_matrix(pose[:3, :3]).as_quat().tolist()
    px, py, pz = pose[:3, 3].tolist()
    return types[POSE_STAMPED](
        header=header,
        pose=types["geometry_msgs/msg/Pose"](
            position=types["geometry_msgs/msg/Point"](x=px, y=py, z=pz),
            orientation=types["geometry_msgs/msg/Quaternion"](x=x, y=y, z=z, w=w),
        ),
    )
