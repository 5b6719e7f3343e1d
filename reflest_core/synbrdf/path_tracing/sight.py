# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Cameras' rays and what they meet. Importing this module loads Mitsuba."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.synbrdf.path_tracing.mitsuba_scene import first_hits

MAX_GRAZING_COSINE = 0.25
"""A view further from the normal (75.5 degrees) does not see a point, as in fusion."""
VISIBLE_TOLERANCE = 2e-3
"""Metres between a point and the first surface along its ray within which it is seen."""


def camera_rays(
    camera: CameraIntrinsics, poses: NDArray[np.float64]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Rays through the pixel centres of every pose.

    Args:
        camera: Pinhole intrinsics.
        poses: ``T_world_camera`` (W, 4, 4), optical frames.

    Returns:
        Origins and unit directions (W * height * width, 3), world frame.
    """
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    local = np.stack(
        [(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones(u.shape)], axis=-1
    ).reshape(-1, 3)
    directions = np.einsum("wij,pj->wpi", poses[:, :3, :3], local)
    origins = np.broadcast_to(poses[:, None, :3, 3], directions.shape)
    return (
        origins.reshape(-1, 3).astype(np.float32),
        unit(directions.reshape(-1, 3).astype(np.float32)),
    )


def in_image(
    positions: NDArray[np.float32], camera: CameraIntrinsics, pose: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Whether points (P,) project into an image.

    Args:
        positions: (P, 3) world frame, metres.
        camera: Pinhole intrinsics.
        pose: ``T_world_camera`` (4, 4), optical frame.
    """
    x, y, z = ((positions - pose[:3, 3]) @ pose[:3, :3]).T
    depth = np.maximum(z, 1e-6)
    u, v = camera.fx * x / depth + camera.cx, camera.fy * y / depth + camera.cy
    is_across = (u > -0.5) & (u < camera.width - 0.5)
    return np.asarray((z > 0.0) & is_across & (v > -0.5) & (v < camera.height - 0.5))


def visible_pairs(
    rendered: Any,
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    centres: NDArray[np.float32],
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Points and views that see each other, wherever the views look.

    Args:
        rendered: The scene as Mitsuba holds it.
        positions: (P, 3) points on its surfaces, metres.
        normals: (P, 3) unit.
        centres: (W, 3) of cameras.

    Returns:
        Indices of points and of views, ordered by point, then view.
    """
    towards = centres[None] - positions[:, None]
    cosines = np.einsum("pwk,pk->pw", unit(towards), normals)
    point_of, view_of = np.nonzero(cosines > MAX_GRAZING_COSINE)
    separation = positions[point_of] - centres[view_of]
    distance = np.linalg.norm(separation, axis=1)
    hit = first_hits(rendered, centres[view_of], unit(separation))
    seen = np.abs(hit - distance) < VISIBLE_TOLERANCE
    return point_of[seen], view_of[seen]


def unit(vectors: NDArray[np.float32]) -> NDArray[np.float32]:
    """Scale vectors to unit length.

    Args:
        vectors: (..., 3), none of them 0.
    """
    scaled: NDArray[np.float32] = vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
    return scaled
