# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the node beside those of the core."""

from __future__ import annotations

from dataclasses import dataclass, field

from reflest_core.parameter import check_parameters, parameter
from reflest_ros.outputs.view_settings import (
    EnvironmentSettings,
    MarkerSettings,
    MaterialSettings,
    PreviewSettings,
    VoxelSettings,
)

NODE_NAME = "reflest_estimator"
"""The node's name, under which its services and diagnostics are found."""


@dataclass(frozen=True)
class TopicSettings:
    """Where the inputs come from, unless ``rgb``, ``depth``, ... are remapped."""

    rgb: str = parameter("camera/color/image_raw", "Colour images.")
    depth: str = parameter(
        "camera/aligned_depth_to_color/image_raw",
        "Depth images, best registered to the colour images; others are registered by the node, "
        "with depth_camera_info and the transform.",
    )
    camera_info: str = parameter("camera/color/camera_info", "Calibration of the colour camera.")
    depth_camera_info: str = parameter(
        "camera/depth/camera_info",
        "Calibration of the depth camera; needed where depth is in another frame than colour.",
    )
    pose: str = parameter(
        "camera/pose",
        "Poses of the camera in the world frame (PoseStamped), with capture.pose_source pose.",
    )
    odom: str = parameter(
        "odom", "Poses of the robot or the camera (Odometry), with capture.pose_source odom."
    )
    mask: str = parameter("camera/mask", "Masks of the scanned object, with capture.use_mask.")

    def __post_init__(self) -> None:
        check_parameters(self)


@dataclass(frozen=True)
class InputSettings:
    """How the inputs are received."""

    reliability: str = parameter(
        "best_effort",
        "Reliability asked of publishers. best_effort receives from every publisher; reliable "
        "loses nothing, and receives from reliable publishers only.",
        choices=("best_effort", "reliable"),
    )
    rgb_transport: str = parameter(
        "raw",
        "compressed: subscribe to CompressedImage (jpeg, png) on topics.rgb + /compressed. "
        "A topic name that ends so is taken as it is.",
        choices=("raw", "compressed"),
    )
    depth_transport: str = parameter(
        "raw",
        "compressedDepth (png, rvl) or compressed (16-bit png): subscribe to "
        "CompressedImage on topics.depth + /compressedDepth or /compressed. A topic name that "
        "ends so is taken as it is.",
        choices=("raw", "compressedDepth", "compressed"),
    )
    mask_transport: str = parameter(
        "raw",
        "compressed: subscribe to CompressedImage (8-bit png) on topics.mask + /compressed.",
        choices=("raw", "compressed"),
    )
    queue_size: int = parameter(
        200,
        "Messages that may wait for fusion; further ones are dropped and counted.",
        minimum=4,
        maximum=100000,
    )
    silence: float = parameter(
        5.0,
        "A warning names each topic that has had no message for this long.",
        unit="s",
        minimum=0.1,
        maximum=3600.0,
    )
    settle: float = parameter(
        0.5,
        "After this long without a message, frames that wait for later messages are used as they "
        "are.",
        unit="s",
        minimum=0.01,
        maximum=60.0,
    )
    reset_on_clock_jump: bool = parameter(
        False,
        "When time goes back (a bag loops, a simulation restarts), begin a new scan; otherwise the "
        "scan continues with the next frames. Waiting messages are dropped either way.",
    )
    diagnostics_period: float = parameter(
        1.0, "Time between two messages on /diagnostics.", unit="s", minimum=0.02, maximum=60.0
    )

    def __post_init__(self) -> None:
        check_parameters(self)


@dataclass(frozen=True)
class LifecycleSettings:
    """How the node comes up."""

    autostart: bool = parameter(
        True, "Configure and activate at the start; otherwise wait for a lifecycle manager."
    )

    def __post_init__(self) -> None:
        check_parameters(self)


@dataclass(frozen=True)
class AutosaveSettings:
    """A file that holds the scan, so that a node that is killed continues it at the next start."""

    path: str = parameter(
        "",
        "File to which the scan is saved regularly and at cleanup, and from which the next start "
        "continues; empty: none. Each node needs its own file.",
    )
    period: float = parameter(
        10.0,
        "Time between two saves of a scan that changes.",
        unit="s",
        minimum=0.1,
        maximum=86400.0,
    )

    def __post_init__(self) -> None:
        check_parameters(self)


@dataclass(frozen=True)
class FileSettings:
    """Files that services may use."""

    root: str = parameter(
        "",
        "Folder in which the services ~/save, ~/load and ~/export may use files; empty: "
        "reflest/NODE_NAME below ROS_HOME or ~/.ros.",
    )
    allow_write: bool = parameter(True, "Whether services may write files.")

    def __post_init__(self) -> None:
        check_parameters(self)


@dataclass(frozen=True)
class NodeSettings:
    """The node's own groups of parameters, in the order of ``config/estimator.yaml``."""

    files: FileSettings = field(default_factory=FileSettings)
    lifecycle: LifecycleSettings = field(default_factory=LifecycleSettings)
    autosave: AutosaveSettings = field(default_factory=AutosaveSettings)
    topics: TopicSettings = field(default_factory=TopicSettings)
    input: InputSettings = field(default_factory=InputSettings)
    preview: PreviewSettings = field(default_factory=PreviewSettings)
    voxels: VoxelSettings = field(default_factory=VoxelSettings)
    environment: EnvironmentSettings = field(default_factory=EnvironmentSettings)
    markers: MarkerSettings = field(default_factory=MarkerSettings)
    materials: MaterialSettings = field(default_factory=MaterialSettings)
