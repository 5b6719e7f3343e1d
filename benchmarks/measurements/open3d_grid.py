# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Open3D's VoxelBlockGrid on the same frames, as the peer."""

from __future__ import annotations

import dataclasses
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.measuring.resident_memory import peak_mb
from benchmarks.measuring.timing import Timing
from benchmarks.scene.table_scene import table_settings
from reflest_core.capture.frame import Frame
from reflest_core.capture.open_capture import open_capture
from reflest_core.export.libraries import open3d
from reflest_core.fusion.frames.foreground import classify_pixels
from reflest_core.fusion.frames.region import Region
from reflest_core.fusion.settings import FusionSettings

BLOCK_COUNT = 20_000
"""Blocks reserved from the start, so that Open3D never has to grow its hash map."""
DEPTH_SCALE = 1000.0
"""Units of 16-bit depth in a metre: with 8-bit colour the image types that Open3D takes as are."""
INTEGRATE, BLOCK_LIST = "integrate", "block list"
IN_REGION = ", depth cut to the region"


def measure(capture: str, stamps: list[str], is_table: bool) -> dict[str, Any]:
    """Time Open3D with colour, as scanners use it, and with depth alone.

    Args:
        capture: Path of the capture.
        stamps: Stamps of the frames to fuse, nanoseconds, as text.
        is_table: Crop to the region of interest of the table scene.
    """
    kinds = (("colour", True), ("depth only", False))
    return {
        name: _fused(Path(capture), set(stamps), with_colour, is_table)
        for name, with_colour in kinds
    }


def _fused(capture: Path, stamps: set[str], with_colour: bool, is_table: bool) -> dict[str, Any]:
    """Integrate the frames with these ``stamps`` at the default voxel size.

    Open3D knows no region of interest: it fuses all depth up to ``max_depth``. For the table, a
    second grid gets the same frames with depth outside the region set to 0.
    """
    settings = table_settings()
    whole, cut = (_Grid(settings.fusion, with_colour) for _ in range(2))
    region = Region.from_settings(settings.region)
    seconds: dict[str, list[float]] = defaultdict(list)
    by_stamp: dict[str, float] = {}
    for frame in open_capture(capture):
        if len(by_stamp) == len(stamps):
            break
        if str(frame.stamp_ns) not in stamps:
            continue
        depth = np.rint(frame.depth * DEPTH_SCALE).astype(np.uint16)
        fused = [(whole, depth, "")]
        if is_table:
            inside = classify_pixels(frame, region, settings.fusion).foreground
            fused.append((cut, depth * inside, IN_REGION))
        for grid, image, suffix in fused:
            listing, integration = grid.integrate(frame, image)
            seconds[BLOCK_LIST + suffix].append(listing)
            seconds[INTEGRATE + suffix].append(integration)
            by_stamp.setdefault(str(frame.stamp_ns), 1000.0 * integration)
    return {
        "stages": [dataclasses.asdict(Timing.of(name, s)) for name, s in seconds.items()],
        "integrate_ms": by_stamp,
        "peak_mb": peak_mb(),
    }


class _Grid:
    def __init__(self, settings: FusionSettings, with_colour: bool) -> None:
        self._o3d = o3d = open3d()
        self._settings = settings
        self._with_colour = with_colour
        names, channels = ("tsdf", "weight", "color"), ((1), (1), (3))
        used = 3 if with_colour else 2
        self._grid = o3d.t.geometry.VoxelBlockGrid(
            names[:used],
            (o3d.core.float32,) * used,
            channels[:used],
            settings.voxel_size,
            8,
            BLOCK_COUNT,
            o3d.core.Device("CPU:0"),
        )

    def integrate(self, frame: Frame, depth_mm: NDArray[np.uint16]) -> tuple[float, float]:
        """Seconds for the list of blocks and for the integration."""
        tensor = self._o3d.core.Tensor
        depth = self._image(depth_mm)
        colour = self._image(frame.rgb)
        camera = tensor(frame.intrinsics.matrix)
        extrinsic = tensor(np.linalg.inv(frame.T_world_camera))
        limits = (DEPTH_SCALE, self._settings.max_depth, self._settings.truncation)
        started = time.perf_counter()
        blocks = self._grid.compute_unique_block_coordinates(depth, camera, extrinsic, *limits)
        listed = time.perf_counter()
        if self._with_colour:
            self._grid.integrate(blocks, depth, colour, camera, camera, extrinsic, *limits)
        else:
            self._grid.integrate(blocks, depth, camera, extrinsic, *limits)
        return listed - started, time.perf_counter() - listed

    def _image(self, pixels: NDArray[np.generic]) -> object:
        return self._o3d.t.geometry.Image(self._o3d.core.Tensor(np.ascontiguousarray(pixels)))
