# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters between the camera's topics and a frame."""

from __future__ import annotations

from dataclasses import dataclass

from reflest_core.capture.pose import matrix_of_parameter
from reflest_core.parameter import ParameterError, check_parameters, parameter

UNKNOWN_TRANSFORM = (0.0,) * 7
SAME_FRAME = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
SMALLEST_SCALE = 1e-6
USUAL_SCALE = 0.001
ROTATED_SCALE = 0.0001


@dataclass(frozen=True)
class CaptureSettings:
    """Matching in time, units and calibration; each field describes itself."""

    slop: float = parameter(
        0.02,
        "Depth and mask further than this from the colour image's stamp do not match it; "
        "0 demands equal stamps.",
        unit="s",
        minimum=0.0,
        maximum=1.0,
    )
    max_pose_gap: float = parameter(
        0.2,
        "Poses further apart than this are not interpolated between.",
        unit="s",
        minimum=0.0,
        maximum=10.0,
    )
    max_wait: float = parameter(
        2.0,
        "A colour image waits for its partners until colour is this far ahead of it (image "
        "time); then it is used with what has come, or refused.",
        unit="s",
        minimum=0.01,
        maximum=60.0,
    )
    clock_jump: float = parameter(
        1.0,
        "Stamps that go back by this much are a jump of the clock (a bag that starts again): "
        "what waits is dropped and matching goes on. Smaller steps are late messages.",
        unit="s",
        minimum=0.01,
        maximum=3600.0,
    )
    queue_size: int = parameter(
        30, "Images of each topic that may wait for their partners.", minimum=2, maximum=1000
    )
    pose_queue_size: int = parameter(
        2000, "Poses that may wait for their image.", minimum=2, maximum=100000
    )
    depth_scale: float = parameter(
        0.0,
        "Metres in one unit of 16-bit depth; 32FC1 depth is in metres. 0: as the format says (TUM "
        "1/5000, ICL-NUIM 1/5000, ...), else 0.001; with depth_encoding rotated 0.0001.",
        unit="m",
        minimum=0.0,
        maximum=1.0,
    )
    depth_kind: str = parameter(
        "z",
        "What a depth pixel measures: z, along the optical axis, or ray, the distance from the "
        "camera centre, as some simulators give it.",
        choices=("z", "ray"),
    )
    depth_encoding: str = parameter(
        "auto",
        "How 16-bit depth is stored: plain, or rotated, read as d >> 3 | d << 13, as in SUN RGB-D "
        "and the APC data sets; auto: as the format says, else plain.",
        choices=("auto", "plain", "rotated"),
    )
    rectified: bool = parameter(
        False, "The images are rectified already: use camera_info's P and ignore its distortion."
    )
    rectified_by_name: bool = parameter(
        True,
        "Take images on a topic named image_rect... as rectified where camera_info has a P and "
        "distortion. A warning says so.",
    )
    check_frame_ids: bool = parameter(
        True,
        "Compare the frames that messages name: depth of another frame than colour is "
        "registered to it or refused, as are a pose of another frame, a calibration of another "
        "camera and a world frame that changes.",
    )
    pose_source: str = parameter(
        "pose",
        "Where poses come from: the topic pose (PoseStamped), the topic odom (Odometry), "
        "or tf, at the image's stamp.",
        choices=("pose", "odom", "tf"),
    )
    world_frame: str = parameter(
        "map", "With pose_source tf: the frame in which the scan is built."
    )
    max_transform_gap: float = parameter(
        1.0,
        "Transforms of one frame further apart than this are not interpolated between.",
        unit="s",
        minimum=0.0,
        maximum=60.0,
    )
    pose_to_camera: tuple[float, ...] = parameter(
        SAME_FRAME,
        "The colour camera's optical frame in the frame whose pose is published: x, y, z in "
        "metres, then quaternion x, y, z, w. Left as it is, it may come from tf.",
    )
    depth_to_rgb: tuple[float, ...] = parameter(
        UNKNOWN_TRANSFORM,
        "For depth that is not registered to colour: the depth camera's optical frame in the "
        "colour camera's: x, y, z in metres, then quaternion x, y, z, w. All 0: taken from tf.",
    )
    use_mask: bool = parameter(
        False, "Wait for a mask image of the scanned object with every colour image."
    )

    def __post_init__(self) -> None:
        check_parameters(self)
        if 0.0 < self.depth_scale < SMALLEST_SCALE:
            raise ParameterError(
                f"depth_scale = {self.depth_scale} m is neither 0 nor at least {SMALLEST_SCALE} m"
            )
        matrix_of_parameter("pose_to_camera", self.pose_to_camera)
        if self.is_depth_to_rgb_set:
            matrix_of_parameter("depth_to_rgb", self.depth_to_rgb)
        if self.pose_source == "tf" and not self.world_frame.strip("/"):
            raise ParameterError("world_frame is empty: pose_source tf needs its name, as map")

    def depth_unit(self, of_format: float | None = None) -> float:
        """Return metres in one unit of 16-bit depth: as the user set it, else the format's own.

        Args:
            of_format: What the capture's format fixes, if it does.
        """
        if self.depth_scale > 0.0:
            return self.depth_scale
        if of_format is not None:
            return of_format
        return ROTATED_SCALE if self.depth_encoding == "rotated" else USUAL_SCALE

    @property
    def is_pose_to_camera_set(self) -> bool:
        """Whether the user gave the camera's place in the frame whose pose is published."""
        return self.pose_to_camera != SAME_FRAME

    @property
    def is_depth_to_rgb_set(self) -> bool:
        """Whether the user gave the transform between the two cameras."""
        return self.depth_to_rgb != UNKNOWN_TRANSFORM
