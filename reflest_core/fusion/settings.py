# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of fusion, the region of interest and keyframes."""

from __future__ import annotations

from dataclasses import dataclass

from reflest_core.parameter import ParameterError, check_parameters, parameter

LARGEST_SIZE = 1e4
"""Metres across a region of interest."""


@dataclass(frozen=True)
class FusionSettings:
    """The TSDF volume and the voxel observation store."""

    voxel_size: float = parameter(
        0.005, "Edge of a TSDF voxel.", unit="m", minimum=0.001, maximum=0.1
    )
    truncation: float = parameter(
        4.0,
        "Distance from the surface at which the signed distance is cut off.",
        unit="voxels",
        minimum=2.0,
        maximum=16.0,
    )
    max_depth: float = parameter(
        3.0, "Depth beyond this is background.", unit="m", minimum=0.1, maximum=20.0
    )
    work_radius: float = parameter(
        0.0,
        "Without a region of interest, what lies farther than this from the scan's centre is"
        " background; 0: about twice the distance from the camera to what it looks at first.",
        unit="m",
        minimum=0.0,
        maximum=100.0,
    )
    memory_budget_mb: float = parameter(
        256.0, "Hard limit on volume and store together.", unit="MB", minimum=16.0, maximum=65536.0
    )
    observations_per_voxel: int = parameter(
        64, "Views kept for each voxel, spread over directions.", minimum=5, maximum=255
    )
    view_spacing: float = parameter(
        2.0,
        "A frame seen from closer than this angle to a stored view (about the scene) adds no view"
        " unless it shows new surface.",
        unit="degrees",
        minimum=0.0,
        maximum=45.0,
    )
    frames_per_view: int = parameter(
        8,
        "Frames fused from about the same view; further ones that show nothing new are redundant"
        " and skipped.",
        minimum=1,
        maximum=100000,
    )
    max_grazing_angle: float = parameter(
        75.0,
        "A view further from the normal than this does not see a voxel.",
        unit="degrees",
        minimum=10.0,
        maximum=89.0,
    )

    normal_smoothing: float = parameter(
        15.0,
        "Normals are averaged over neighbouring voxels whose normals differ by about this angle or"
        " less; 0: not.",
        unit="degrees",
        minimum=0.0,
        maximum=60.0,
    )
    depth_edge_margin: int = parameter(
        2,
        "Pixels this close to a depth edge give no colour and no surface.",
        unit="pixels",
        minimum=1,
        maximum=20,
    )
    on_jump: str = parameter(
        "new_scan",
        "When the tracker jumps in mid-scan, as at a loop closure: new_scan drops what was scanned "
        "before and goes on from there, drop goes on in the same scan and drops what later frames "
        "contradict, keep goes on with everything. All say so in the status.",
        choices=("new_scan", "drop", "keep"),
    )
    threads: int = parameter(
        2,
        "Threads that share the work on a frame; results do not depend on it.",
        minimum=1,
        maximum=64,
    )

    def __post_init__(self) -> None:
        check_parameters(self)


@dataclass(frozen=True)
class RegionSettings:
    """The region of interest in the world frame: what lies inside is the scanned object."""

    shape: str = parameter(
        "none",
        "Region of interest: none, box (axis-aligned) or sphere.",
        choices=("none", "box", "sphere"),
    )
    centre: tuple[float, float, float] = parameter(
        (0.0, 0.0, 0.0),
        "Centre of the region in the world frame.",
        unit="m",
        minimum=-1e7,
        maximum=1e7,
    )
    size: tuple[float, float, float] = parameter(
        (1.0, 1.0, 1.0),
        "Edges of the box; a sphere uses the first value as its diameter.",
        unit="m",
        minimum=0.0,
        maximum=LARGEST_SIZE,
    )

    def __post_init__(self) -> None:
        check_parameters(self)
        used = {"none": (), "box": self.size, "sphere": self.size[:1]}[self.shape]
        if not all(length > 0.0 for length in used):
            needed = "every edge" if self.shape == "box" else "a diameter (the first value)"
            shown = ", ".join(f"{length:g}" for length in self.size)
            raise ParameterError(f"size = [{shown}] m: a {self.shape} needs {needed} above 0")

    @classmethod
    def sphere(cls, centre: tuple[float, float, float], radius: float) -> RegionSettings:
        """Return a sphere given by its radius.

        Args:
            centre: World frame, metres.
            radius: Metres.

        Raises:
            ParameterError: The radius or the centre is out of range.
        """
        if not 0.0 < radius <= LARGEST_SIZE / 2:
            raise ParameterError(
                f"radius = {radius:g} m: it must be above 0 and at most {LARGEST_SIZE / 2:g}"
            )
        return cls("sphere", centre, (2.0 * radius,) * 3)


@dataclass(frozen=True)
class KeyframeSettings:
    """When an estimate is made: movement or time since the last keyframe."""

    translation: float = parameter(
        0.15, "Camera movement that makes a keyframe.", unit="m", minimum=0.001, maximum=100.0
    )
    rotation: float = parameter(
        15.0, "Camera rotation that makes a keyframe.", unit="degrees", minimum=0.1, maximum=180.0
    )
    interval: float = parameter(
        2.0,
        "Image time since the last keyframe that makes one.",
        unit="s",
        minimum=0.01,
        maximum=3600.0,
    )

    def __post_init__(self) -> None:
        check_parameters(self)
