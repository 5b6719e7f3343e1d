# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Full RGB-D images: path-traced radiance and the exact depth at the pixel centres.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.light.equirectangular import radiance_from
from reflest_core.synbrdf.path_tracing.mitsuba_scene import (
    PATH_DEPTH,
    RadianceTracer,
    first_hits,
    first_normals,
)
from reflest_core.synbrdf.path_tracing.sight import camera_rays
from reflest_core.synbrdf.room.depth_view import room_sight
from reflest_core.synbrdf.room.geometry import Room

SUBPIXELS = 2
"""A pixel is the mean of SUBPIXELS x SUBPIXELS rays through it."""


@dataclass(frozen=True)
class FullImage:
    """An image of a scene; all but the radiance is exact at the pixel centres.

    In a room depth and normals are those of its walls, too, as far as a depth camera measures them.

    Attributes:
        radiance: (H, W, 3) float32, linear Rec. 709.
        depth: (H, W) float32, Z along the optical axis in metres, 0 where the environment is seen.
        normals: (H, W, 3) float32, unit, world frame, as shaded; 0 where depth is 0.
        cosines: (H, W) float32, between the normal and the direction to the camera.
        is_object: (H, W) bool.
    """

    radiance: NDArray[np.float32]
    depth: NDArray[np.float32]
    normals: NDArray[np.float32]
    cosines: NDArray[np.float32]
    is_object: NDArray[np.bool_]


class FullImageRenderer:
    """Renders images of one camera, one pose after another, with one set of kernels."""

    def __init__(self, camera: CameraIntrinsics, samples: int, depth: int = PATH_DEPTH) -> None:
        """Prepare kernels.

        Args:
            camera: Pinhole intrinsics.
            samples: Paths a pixel, a multiple of ``SUBPIXELS`` squared.
            depth: Mitsuba's ``max_depth``.
        """
        self.camera = camera
        self.tracer = RadianceTracer(samples // SUBPIXELS**2, lanes=1 << 20, depth=depth)

    def render(
        self,
        rendered: Any,
        environment: NDArray[np.float32],
        pose: NDArray[np.float64],
        seed: int,
        room: Room | None = None,
    ) -> FullImage:
        """Render an image.

        What is traced (the object and its outline; all of a room) is denoised; the environment has
        no noise.

        Args:
            rendered: the Mitsuba scene.
            environment: (H, 2 H, 3) linear radiance, equirectangular.
            pose: (4, 4) ``T_world_camera``.
            seed: of the random numbers.
            room: the room that the object stands in; None for distant light.
        """
        shape = (self.camera.height, self.camera.width)
        origins, directions = camera_rays(self.camera, pose[None])
        distance = first_hits(rendered, origins, directions)
        forward = pose[:3, 2].astype(np.float32)
        hit = np.isfinite(distance)
        depth = np.where(hit, np.where(hit, distance, 0.0) * (directions @ forward), 0.0)
        radiance = radiance_from(environment, directions)
        # A pixel beside the object's outline may be partly covered by it.
        near = binary_dilation(hit.reshape(shape), np.ones((3, 3), bool)).reshape(-1)
        if room is not None:
            axes = np.broadcast_to(pose[:3, 2], directions.shape)
            sight = room_sight(rendered, room, origins, directions, axes)
            depth, hit = sight.depth, sight.is_object
            near = np.ones(len(directions), bool)
        radiance[near] = self._traced(rendered, pose, near, seed)
        image = radiance.reshape(*shape, 3)
        denoised = _denoised(image)
        normals = first_normals(rendered, origins, directions)
        cosines = np.abs(np.einsum("ij,ij->i", normals, directions))
        return FullImage(
            np.where(near.reshape(shape)[..., None], denoised, image),
            depth.reshape(shape).astype(np.float32),
            normals.reshape(*shape, 3),
            cosines.reshape(shape),
            hit.reshape(shape),
        )

    def _traced(
        self, rendered: Any, pose: NDArray[np.float64], chosen: NDArray[np.bool_], seed: int
    ) -> NDArray[np.float32]:
        """Radiance (R, 3) of the chosen pixels, over a regular grid of rays in each."""
        offsets = (np.arange(SUBPIXELS) + 0.5) / SUBPIXELS - 0.5
        rays = [
            camera_rays(
                dataclasses.replace(self.camera, cx=self.camera.cx - dx, cy=self.camera.cy - dy),
                pose[None],
            )
            for dy in offsets
            for dx in offsets
        ]
        origins = np.concatenate([origin[chosen] for origin, _ in rays])
        directions = np.concatenate([direction[chosen] for _, direction in rays])
        radiance = self.tracer.trace(rendered, origins, directions, seed)
        return np.asarray(radiance.reshape(SUBPIXELS**2, -1, 3).mean(axis=0))


def _denoised(radiance: NDArray[np.float32]) -> NDArray[np.float32]:
    import pyoidn

    return np.asarray(pyoidn.denoise(np.ascontiguousarray(radiance), hdr=True), np.float32)
