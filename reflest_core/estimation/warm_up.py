"""Compiles fusion and estimation before the first real frame has to wait for it."""

from __future__ import annotations

import contextlib
import dataclasses

import numpy as np

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.frame import Frame
from reflest_core.estimation.estimator import NoEstimate
from reflest_core.estimation.scanner import Scanner
from reflest_core.estimation.settings import ReflestSettings

INTRINSICS = CameraIntrinsics(width=64, height=48, fx=60.0, fy=60.0, cx=31.5, cy=23.5)
DISTANCE = 0.5
STEP = 0.05


def warm_up(settings: ReflestSettings) -> None:
    """Send frames of a grey wall through a scanner of its own and estimate from them.

    Numba keeps what it compiles on disk: this takes half a minute after installation and a
    second from then on.
    """
    small = ReflestSettings(
        fusion=dataclasses.replace(settings.fusion, voxel_size=0.02, memory_budget_mb=16.0),
        estimation=dataclasses.replace(settings.estimation, min_voxels=1),
    )
    scanner = Scanner(small)
    shape = (INTRINSICS.height, INTRINSICS.width)
    for index in range(3):
        T_world_camera = np.eye(4)
        T_world_camera[0, 3] = index * STEP
        frame = Frame(
            stamp_ns=index,
            rgb=np.full((*shape, 3), 128, np.uint8),
            depth=np.full(shape, DISTANCE, np.float32),
            T_world_camera=T_world_camera,
            intrinsics=INTRINSICS,
        )
        scanner.fuse(frame)
    with contextlib.suppress(NoEstimate):
        scanner.estimate(scanner.snapshot(0, ""))
