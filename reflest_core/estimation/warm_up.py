# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Compiles capture, fusion and estimation before the first real frame has to wait for it.

``python -m reflest_core.estimation.warm_up`` does so after an installation.
"""

from __future__ import annotations

import subprocess
import sys

import numpy as np

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.images.decode import decode_depth
from reflest_core.capture.images.depth_registration import register_depth
from reflest_core.capture.images.rvl import decode_rvl
from reflest_core.capture.messages import ImageMessage
from reflest_core.capture.settings import CaptureSettings
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.scan_memory import ScanMemory
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.fusion.warm_up import warm_up as warm_up_fusion
from reflest_core.light.light_map import SIZE, LightMap
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.models.registry import shipped_models
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.voxel_key import pack_key

_warmed: set[tuple[EstimationSettings, bool]] = set()
"""What this process is warm for."""
SIDE, VIEWS = 32, 6
"""32 x 32 voxels are more than any network chooses or ``min_voxels`` can ask for."""


def warm_up(estimator: Estimator, is_divided: bool = True) -> None:
    """Run every kernel once: a second or two, or about two minutes on the first start.

    A process that did so with the same settings has nothing left to do.

    Args:
        estimator: with the network that will be used.
        is_divided: also what divides a scan into materials, as one without a region is.
    """
    if (estimator.settings, is_divided) in _warmed:
        return
    _warm_up_capture()
    warm_up_fusion()
    _warm_up_estimation(estimator, is_divided)
    _warmed.add((estimator.settings, is_divided))


def _warm_up_estimation(estimator: Estimator, is_divided: bool = True) -> None:
    """Run the kernels between a scan and its estimates once."""
    wall = _wall_of_two_colours()
    estimator.estimate(wall, 0, "")
    if is_divided:
        estimator.segmented_materials(wall, ScanMemory(), 0, "")


def _warm_up_capture() -> None:
    """Run capture's kernels once, and fill the table of metres of the default depth unit."""
    pixel = CameraIntrinsics(width=1, height=1, fx=1.0, fy=1.0, cx=0.0, cy=0.0)
    register_depth(np.ones((1, 1), np.float32), pixel, np.eye(4), pixel)
    decode_rvl(bytes(4), 1, 1)
    depth = ImageMessage(0, "", 1, 1, "16UC1", False, 2, bytes(2))
    decode_depth(depth, "", CaptureSettings().depth_unit())


def _wall_of_two_colours() -> ObservedSurface:
    """A square wall at z = 0, every voxel seen from every view, in a light from one side."""
    light = LightMap()
    directions = octahedral_directions(SIZE).reshape(-1, 3)
    directions = directions[directions[:, 2] > 0.0]
    light.add(
        directions, np.where(directions[:, :1] > 0.2, [[200] * 3], [[30] * 3]).astype(np.uint8)
    )
    voxels = SIDE**2
    column, row = np.arange(voxels) % SIDE, np.arange(voxels) // SIDE
    of_voxels = np.where(column[:, None] < SIDE // 2, [[180, 60, 40]], [[50, 80, 150]])
    # Views differ a little, as those of a glossy surface do.
    colours = of_voxels[:, None] + 2 * np.arange(VIEWS)[:, None]
    return ObservedSurface(
        positions=np.stack([0.005 * column, 0.005 * row, 0.0 * row], axis=1).astype(np.float32),
        normals=np.tile(np.array([0.0, 0.0, 1.0], np.float32), (voxels, 1)),
        offsets=np.arange(voxels + 1, dtype=np.int64) * VIEWS,
        colours=colours.reshape(-1, 3).astype(np.uint8),
        view_indices=np.tile(np.arange(VIEWS, dtype=np.uint16), voxels),
        view_centres=np.array([[0.1 * view, 0.0, 0.5] for view in range(VIEWS)], np.float32),
        view_foreground=np.full((VIEWS, 3), 128.0, np.float32),
        view_background=np.full((VIEWS, 3), np.nan, np.float32),
        light=light.observed(),
        keys=np.array([pack_key(n % SIDE, n // SIDE, 0) for n in range(voxels)]),
    )


def compile_all() -> int:
    """Compile all kernels of all networks, in two processes: each takes half a minute.

    Returns:
        Exit code of the second process.
    """
    with subprocess.Popen([sys.executable, "-m", "reflest_core.fusion.warm_up"]) as fusion:
        _warm_up_capture()
        for model in shipped_models():
            _warm_up_estimation(Estimator(EstimationSettings(model=model)))
    return fusion.returncode


if __name__ == "__main__":
    sys.exit(compile_all())
