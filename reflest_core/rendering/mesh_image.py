# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A triangle mesh with coloured vertices as a camera sees it, without a graphics card."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics

FRACTION_BITS = 4
"""Of the pixel positions that corners are rounded to."""
SUPERSAMPLING = 2
"""Pixels along each edge that are averaged."""
NEAR = 0.01
"""Metres; triangles that come nearer are left out."""


def mesh_image(
    vertices: NDArray[np.float32],
    faces: NDArray[np.int32],
    colours: NDArray[np.uint8],
    background: NDArray[np.uint8],
    camera: CameraIntrinsics,
    T_world_camera: NDArray[np.float64],
) -> NDArray[np.uint8]:
    """Draw triangles from far to near, each in the mean colour of its corners.

    Args:
        vertices: (N, 3) world frame, metres.
        faces: (F, 3) indices of vertices; both sides are drawn.
        colours: (N, 3) 8-bit sRGB.
        background: (H, W, 3) 8-bit sRGB, what is seen where no triangle lies.
        camera: intrinsics; the image has the size of ``background``, whatever the camera's is.
        T_world_camera: (4, 4) pose of the optical frame: x right, y down, z ahead.

    Returns:
        (H, W, 3) 8-bit sRGB.
    """
    height, width = background.shape[:2]
    zoom = SUPERSAMPLING * width / camera.width
    turned = (vertices - T_world_camera[:3, 3]) @ T_world_camera[:3, :3]
    distance = np.maximum(turned[:, 2], NEAR)
    # A pixel's middle is a whole number, as in ROS and OpenCV.
    across = (turned[:, 0] / distance * camera.fx + camera.cx + 0.5) * zoom - 0.5
    down = (turned[:, 1] / distance * camera.fy + camera.cy + 0.5) * zoom - 0.5
    corners = np.stack([across, down], axis=1)[faces]
    depth = turned[faces, 2]
    size = np.array([width, height]) * SUPERSAMPLING
    in_image = ((corners.max(axis=1) >= 0) & (corners.min(axis=1) <= size)).all(axis=1)
    shown = np.flatnonzero(in_image & (depth.min(axis=1) > NEAR))
    order = shown[np.argsort(-depth[shown].mean(axis=1), kind="stable")]
    places = np.rint(corners * (1 << FRACTION_BITS)).astype(np.int32)
    mean = colours[faces].astype(np.float64).mean(axis=1)
    image = cv2.resize(background, size.tolist(), interpolation=cv2.INTER_NEAREST)
    for face in order:
        cv2.fillConvexPoly(image, places[face], mean[face].tolist(), cv2.LINE_8, FRACTION_BITS)
    return np.asarray(cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA), np.uint8)


def ray_directions(
    camera: CameraIntrinsics, T_world_camera: NDArray[np.float64], height: int, width: int
) -> NDArray[np.float64]:
    """Where each pixel of a scaled image looks.

    Args:
        camera: intrinsics.
        T_world_camera: (4, 4) pose of the optical frame.
        height: of the scaled image, pixels.
        width: of the scaled image, pixels.

    Returns:
        (height, width, 3) unit, world frame.
    """
    zoom = camera.width / width
    across, down = np.meshgrid(np.arange(width), np.arange(height))
    x = ((across + 0.5) * zoom - 0.5 - camera.cx) / camera.fx
    y = ((down + 0.5) * zoom - 0.5 - camera.cy) / camera.fy
    rays = np.stack([x, y, np.ones_like(x)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    return np.asarray(rays @ T_world_camera[:3, :3].T)
