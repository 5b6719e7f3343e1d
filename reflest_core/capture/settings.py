"""What a user can turn between the camera's topics and a frame."""

from __future__ import annotations

from dataclasses import dataclass

from reflest_core.capture.pose import pose_to_camera_matrix
from reflest_core.parameter import check_parameters, parameter


@dataclass(frozen=True)
class CaptureSettings:
    """Matching in time, units and calibration."""

    slop: float = parameter(
        0.02, "Depth and mask further than this from the colour image's stamp do not match it; "
        "0 demands equal stamps.", unit="s", minimum=0.0, maximum=1.0,
    )  # fmt: skip
    max_pose_gap: float = parameter(
        0.2, "Poses further apart than this are not interpolated between.",
        unit="s", minimum=0.0, maximum=10.0,
    )  # fmt: skip
    queue_size: int = parameter(
        30, "Images of each topic that may wait for their partners.", minimum=2, maximum=1000
    )
    pose_queue_size: int = parameter(
        2000, "Poses that may wait for their image.", minimum=2, maximum=100000
    )
    depth_scale: float = parameter(
        0.001, "Metres in one unit of 16-bit depth; 32FC1 depth is in metres.",
        unit="m", minimum=1e-6, maximum=1.0,
    )  # fmt: skip
    rectified: bool = parameter(
        False, "The images are rectified already: use camera_info's P and ignore its distortion."
    )
    check_frame_ids: bool = parameter(
        True, "Refuse depth that is not in the colour image's frame, and odometry of another "
        "frame unless pose_to_camera is set.",
    )  # fmt: skip
    pose_to_camera: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0),
        "The colour camera's optical frame in the frame whose pose is published: "
        "x, y, z in metres, then quaternion x, y, z, w.",
    )
    use_mask: bool = parameter(
        False, "Wait for a mask image of the scanned object with every colour image."
    )

    def __post_init__(self) -> None:
        check_parameters(self)
        pose_to_camera_matrix(self.pose_to_camera)
