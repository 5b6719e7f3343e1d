# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scanning from Python: arrays in, materials out."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from numpy.typing import ArrayLike

from reflest_core.api.arguments import (
    ArgumentRefused,
    checked_colour,
    checked_depth,
    checked_frame,
    checked_intrinsics,
    checked_number,
    checked_pose,
    checked_region,
    checked_stamp,
    checked_stamp_ns,
    checked_vector,
)
from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.frame import Frame
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.material_map import MaterialMap
from reflest_core.estimation.pipeline import EVERY_VOXEL, Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.export.environment_file import export_environment
from reflest_core.export.exporter import checked_format, export_scan
from reflest_core.export.scan_asset import AssetSettings
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.snapshot import MATERIAL_VOXELS
from reflest_core.jit import announce_compilation
from reflest_core.whole_file import check_writable

FRAME_NS = 33_333_333
"""Nanoseconds between frames without a stamp: 30 Hz."""
ENVIRONMENT_SUFFIXES = {".hdr": "hdr", ".exr": "exr"}


def sphere(centre: tuple[float, float, float], radius: float) -> RegionSettings:
    """Define a region of interest.

    Args:
        centre: world frame, metres.
        radius: metres.

    Raises:
        ReflestError: They are not such numbers, or out of range.
    """
    return RegionSettings.sphere(checked_vector("centre", centre), checked_number("radius", radius))


def box(centre: tuple[float, float, float], size: tuple[float, float, float]) -> RegionSettings:
    """Define an axis-aligned region of interest.

    Args:
        centre: world frame, metres.
        size: edges along x, y and z, metres.

    Raises:
        ReflestError: They are not such numbers, or out of range.
    """
    return RegionSettings("box", checked_vector("centre", centre), checked_vector("size", size))


class Scanner:
    """Estimates the materials of what a few frames show.

    Example:
        >>> from reflest_core import Scanner, sphere
        >>> scanner = Scanner(region=sphere((0.0, 0.0, 0.1), 0.15), voxel_size=0.005)
        >>> for rgb, depth, K, T_world_camera in frames:  # doctest: +SKIP
        ...     scanner.add(rgb, depth, K, T_world_camera)
        >>> print(scanner.estimate().rho_d)  # doctest: +SKIP
    """

    def __init__(
        self,
        region: RegionSettings | None = None,
        up: tuple[float, float, float] = (0.0, 0.0, 1.0),
        voxel_size: float = 0.005,
        depth_scale: float | None = None,
        model: str = "lightnet",
        settings: ReflestSettings | None = None,
    ) -> None:
        """Load the network and allocate the scan.

        Args:
            region: of interest, from :func:`sphere` or :func:`box`; None scans everything near.
            up: direction in the world frame that points up, any length.
            voxel_size: edge of a voxel, metres.
            depth_scale: metres in one unit of the depth images; None: they are floats in metres.
            model: the network that estimates, see ``reflest replay --help``.
            settings: all further parameters; the arguments before go over it.

        Raises:
            ReflestError: A value is out of its range, or the weights cannot be read.
        """
        if depth_scale is not None:
            depth_scale = checked_number("depth_scale", depth_scale)
            if not 0.0 < depth_scale < math.inf:
                raise ArgumentRefused(f"depth_scale is {depth_scale}: expected metres a unit, > 0")
        base = settings or ReflestSettings()
        size = checked_number("voxel_size", voxel_size)
        fusion: FusionSettings = replace(base.fusion, voxel_size=size)
        estimation: EstimationSettings = replace(
            base.estimation, up=checked_vector("up", up), model=model
        )
        chosen = base.region if region is None else checked_region(region)
        self._pipeline = Pipeline(
            replace(base, fusion=fusion, estimation=estimation, region=chosen)
        )
        self._depth_scale = depth_scale
        announce_compilation()
        self._next_stamp_ns = 0

    def add(
        self,
        rgb: ArrayLike,
        depth: ArrayLike,
        K: ArrayLike | CameraIntrinsics,
        T_world_camera: ArrayLike,
        stamp: float | None = None,
    ) -> None:
        """Fuse one frame.

        Args:
            rgb: (H, W, 3) uint8, 8-bit sRGB.
            depth: (H, W), registered to ``rgb``: Z along the optical axis, metres as floats, or
                integers in units of ``depth_scale``; 0 or NaN where unknown.
            K: (3, 3) pinhole calibration in pixels, or fx, fy, cx, cy, or a frame's intrinsics.
            T_world_camera: (4, 4) pose of the camera's optical frame.
            stamp: seconds, later than the frame before; None: 1/30 s after it.

        Raises:
            ArgumentRefused: An array is not what it has to be.
            FrameRefused: The frame shows nothing that can be used; the scan is as it was.
        """
        colour = checked_colour(rgb)
        shape = (colour.shape[0], colour.shape[1])
        next_ns = self._next_stamp_ns
        stamp_ns = checked_stamp_ns(next_ns) if stamp is None else checked_stamp(stamp)
        self._pipeline.fuse(
            Frame(
                stamp_ns,
                colour,
                checked_depth(depth, shape, self._depth_scale),
                checked_pose(T_world_camera),
                checked_intrinsics(K, shape),
            )
        )
        self._next_stamp_ns = stamp_ns + FRAME_NS

    def add_frame(self, frame: Frame) -> None:
        """Fuse a frame of :func:`~reflest_core.capture.open_capture.open_capture`.

        Args:
            frame: as the capture yields it.

        Raises:
            ArgumentRefused: It is no such frame.
            FrameRefused: The frame shows nothing that can be used; the scan is as it was.
        """
        self._pipeline.fuse(checked_frame(frame))
        self._next_stamp_ns = frame.stamp_ns + FRAME_NS

    def estimate(self) -> BrdfEstimate:
        """Estimate the region's material, or else the one in the middle of the last view.

        Raises:
            NoEstimate: Too little was scanned; the sentence says what is missing.
        """
        return self._pipeline.estimate(self._pipeline.snapshot())

    def materials(self) -> MaterialMap:
        """Estimate the BRDF of each material that was scanned.

        Raises:
            NoEstimate: Too little was scanned; the sentence says what is missing.
        """
        return self._pipeline.materials(self._pipeline.snapshot(MATERIAL_VOXELS))

    def export(self, path: Path | str) -> None:
        """Write the scanned surface with its materials, or the light, to a file.

        Args:
            path: its suffix names the format: ``.glb``, ``.gltf``, ``.usda``, ``.usdz``, ``.ply``,
                ``.obj``, ``.sdf`` or ``.xml`` (Mitsuba) for the surface, which needs the extra
                ``asset``; ``.hdr`` or ``.exr`` for the light.

        Raises:
            ReflestError: An unknown suffix, too little was scanned, or the file cannot be written.
        """
        path = Path(path)
        check_writable(path)
        if path.suffix in ENVIRONMENT_SUFFIXES:
            surface = self._pipeline.snapshot().surface
            export_environment(surface, ENVIRONMENT_SUFFIXES[path.suffix], path)
            return
        checked_format(path)
        up = self._pipeline.settings.estimation.up
        found = self._pipeline.materials(self._pipeline.snapshot(EVERY_VOXEL))
        export_scan(self._pipeline.scan, found, path, settings=AssetSettings(up=up))

    def save(self, path: Path | str) -> None:
        """Write the scan to a file that :meth:`load` and ``reflest export`` read.

        Args:
            path: it is replaced if it exists.

        Raises:
            ReflestError: The file cannot be written.
        """
        check_writable(Path(path))
        self._pipeline.save(Path(path))

    def load(self, path: Path | str = "") -> None:
        """Go on from a saved scan; this one stays as it was if that fails.

        Args:
            path: a scan file.

        Raises:
            ReflestError: The file is no scan or is damaged, or no scanner was made before.
        """
        if not isinstance(self, Scanner):
            raise ArgumentRefused(
                "Scanner.load needs a scanner: scanner = Scanner(), then scanner.load(path)"
            )
        self._pipeline.load(Path(path))
