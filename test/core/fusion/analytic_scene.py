# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Spheres rendered analytically: exact depth, one known colour per view and sphere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.capture.frame import Frame

SMALL_CAMERA = CameraIntrinsics(width=160, height=120, fx=140.0, fy=140.0, cx=79.5, cy=59.5)
BACKGROUND = np.array([10, 20, 30], np.uint8)


@dataclass(frozen=True)
class Sphere:
    centre: tuple[float, float, float]
    radius: float


OBJECT = Sphere((0.0, 0.0, 0.0), 0.1)


def look_at(camera_centre, target=(0.0, 0.0, 0.0)):
    """T_world_camera of an optical frame at ``camera_centre`` that looks at ``target``, z up."""
    camera_centre = np.asarray(camera_centre, np.float64)
    forward = np.asarray(target, np.float64) - camera_centre
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    T = np.eye(4)
    T[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    T[:3, 3] = camera_centre
    return T


def orbit(n, count, distance=0.5, elevation_degrees=25.0):
    """Camera centre ``n`` of ``count`` around the origin, rising and falling a little."""
    azimuth = 2.0 * np.pi * n / count
    elevation = np.radians(elevation_degrees) * np.sin(3.0 * azimuth + 0.3)
    return distance * np.array(
        [
            np.cos(azimuth) * np.cos(elevation),
            np.sin(azimuth) * np.cos(elevation),
            np.sin(elevation),
        ]
    )


def colour_of(view, sphere_index):
    """The colour that every pixel of a sphere has in a view."""
    return np.array([50 + 3 * view, 100 + 50 * sphere_index, 200 - view], np.uint8)


def render(spheres, T_world_camera, view, camera=SMALL_CAMERA, background_depth=0.0, stamp_ns=None):
    """A frame of the spheres; the background has ``background_depth`` (0: unknown)."""
    v, u = np.mgrid[: camera.height, : camera.width].astype(np.float64)
    rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones_like(u)], -1)
    world_rays = rays @ T_world_camera[:3, :3].T
    depth = np.full(u.shape, np.inf)
    rgb = np.broadcast_to(BACKGROUND, (*u.shape, 3)).copy()
    for index, sphere in enumerate(spheres):
        to_camera = T_world_camera[:3, 3] - np.asarray(sphere.centre)
        a = np.sum(world_rays**2, -1)
        b = world_rays @ to_camera
        c = to_camera @ to_camera - sphere.radius**2
        square = b**2 - a * c
        z = np.where(square > 0.0, (-b - np.sqrt(np.maximum(square, 0.0))) / a, np.inf)
        nearer = (z > 0.0) & (z < depth)
        depth[nearer] = z[nearer]
        rgb[nearer] = colour_of(view, index)
    depth[np.isinf(depth)] = background_depth
    return Frame(
        stamp_ns=(view + 1) * 33_000_000 if stamp_ns is None else stamp_ns,
        rgb=rgb,
        depth=depth.astype(np.float32),
        T_world_camera=T_world_camera,
        intrinsics=camera,
        frame_id="world",
    )


def orbit_frames(count, spheres=(OBJECT,), **options):
    return [render(spheres, look_at(orbit(n, count)), n, **options) for n in range(count)]
