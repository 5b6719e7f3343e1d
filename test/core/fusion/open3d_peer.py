# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Open3D's VoxelBlockGrid as a peer to hold our surface to.

open3d links to the system's libusb-1.0 (Debian ``libusb-1.0-0``); where there is none, the one in
the PyPI package ``libusb-package`` is loaded first.
"""

from __future__ import annotations

import ctypes
import importlib

import numpy as np


def import_open3d():
    try:
        return importlib.import_module("open3d")
    except ImportError:
        import libusb_package

        ctypes.CDLL(str(libusb_package.get_library_path()), mode=ctypes.RTLD_GLOBAL)
        return importlib.import_module("open3d")


def open3d_surface(frames, voxel_size, truncation_voxels, max_depth):
    """(N, 3) points on the zero level of Open3D's fusion of the frames, world frame, metres."""
    o3d = import_open3d()
    core = o3d.core
    grid = o3d.t.geometry.VoxelBlockGrid(
        attr_names=("tsdf", "weight"),
        attr_dtypes=(core.float32, core.float32),
        attr_channels=((1), (1)),
        voxel_size=voxel_size,
        block_resolution=8,
        block_count=5000,
        device=core.Device("CPU:0"),
    )
    for frame in frames:
        depth = o3d.t.geometry.Image(core.Tensor(np.ascontiguousarray(frame.depth)))
        K = core.Tensor(frame.intrinsics.matrix)
        extrinsic = core.Tensor(np.linalg.inv(frame.T_world_camera))
        blocks = grid.compute_unique_block_coordinates(
            depth, K, extrinsic, 1.0, max_depth, truncation_voxels
        )
        grid.integrate(blocks, depth, K, extrinsic, 1.0, max_depth, truncation_voxels)
    return grid.extract_point_cloud(3.0).point.positions.numpy()
