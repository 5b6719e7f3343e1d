# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``~/material_at``: the material under a pixel or at a point, out of the latest map."""

from __future__ import annotations

import math

import numpy as np
from geometry_msgs.msg import Point
from numpy.typing import NDArray

from reflest_core.capture.pose import FURTHEST
from reflest_core.errors import ReflestError
from reflest_core.fusion.frames.region import RegionShape
from reflest_core.rendering.material_labels import NOTHING, voxel_near, voxels_in_image
from reflest_ros.outputs.material_message import material_to_message, unknown_material
from reflest_ros.outputs.material_output import MaterialOutput, ShownMaterials
from reflest_ros.services.answers import answer_with
from reflest_ros.services.service_pool import ServicePool
from reflest_ros.srv import MaterialAt

REACH = 2.0
"""Voxels from a point to the surface, at most."""


class MaterialServices:
    """Answers from what was published; nothing is estimated."""

    def __init__(self, pool: ServicePool, output: MaterialOutput) -> None:
        """Create the service.

        Args:
            pool: Answers it.
            output: Holds the latest map.
        """
        self._output = output
        pool.create(MaterialAt, "~/material_at", self.material_at)

    def material_at(
        self, request: MaterialAt.Request, response: MaterialAt.Response
    ) -> MaterialAt.Response:
        """Find the material at a point of the world or under a pixel of the latest image.

        Args:
            request: as it was received.
            response: to fill in.
        """
        response.material = unknown_material()
        response.rho_d = response.rho_d_stddev = [math.nan] * 3

        def work() -> str:
            shown = self._output.latest
            if shown is None:
                raise ReflestError(
                    "there is no material map yet: subscribe to reflectance/materials, or set "
                    "materials.when to always, and scan until the next keyframe"
                )
            voxel = _voxel(shown, request)
            materials = shown.materials
            x, y, z = map(float, materials.surface.world_positions[voxel])
            response.position = Point(x=x, y=y, z=z)
            material = materials.material(int(materials.material_ids[voxel]))
            if material is None:
                raise ReflestError("the surface there belongs to no material yet: scan more of it")
            response.material = material_to_message(material)
            response.rho_d = materials.rho_d[voxel].astype(float).tolist()
            response.rho_d_stddev = materials.rho_d_stddev[voxel].astype(float).tolist()
            estimate = material.estimate
            return (
                f"material {material.id}, rho_s {estimate.rho_s:.3f}, alpha {estimate.alpha:.3f}, "
                f"{estimate.status.name}"
            )

        return answer_with(response, work)


def _voxel(shown: ShownMaterials, request: MaterialAt.Request) -> int:
    """The voxel that a request names; a :class:`ReflestError` where there is none."""
    surface, voxel_size = shown.materials.surface, shown.request.voxel_size
    positions = surface.positions
    if request.kind == MaterialAt.Request.KIND_POINT:
        point = np.array([request.point.x, request.point.y, request.point.z])
        if not np.isfinite(point).all():
            raise ReflestError("the point is not finite")
        if np.abs(point).max() >= FURTHEST:
            raise ReflestError(
                f"the point lies {FURTHEST:.0e} m or more from the origin: give metres in the "
                "world frame"
            )
        found = voxel_near(positions, point - surface.origin, REACH * voxel_size)
        if found is None:
            raise ReflestError(
                f"no scanned surface is within {REACH * voxel_size:g} m of the point"
                f"{_bounds_missed(shown, point)}"
            )
        return found
    if request.kind != MaterialAt.Request.KIND_PIXEL:
        raise ReflestError(f"kind = {request.kind} is none of the KIND_ constants: 0 or 1")
    view = shown.view
    if view is None:
        raise ReflestError("no image has been fused since the scan was loaded: name a point")
    width, height = view.intrinsics.width, view.intrinsics.height
    if not (0.0 <= request.u < width and 0.0 <= request.v < height):
        raise ReflestError(f"the pixel is not in the image of {width} x {height} pixels")
    u, v = int(request.u), int(request.v)
    voxel = int(voxels_in_image(positions, view, voxel_size)[v, u])
    if voxel == NOTHING:
        raise ReflestError(f"no scanned surface is under the pixel{_pixel_missed(shown, u, v)}")
    return voxel


def _bounds_missed(shown: ShownMaterials, point: NDArray[np.float64]) -> str:
    """Why a point cannot have been scanned, as the rest of a sentence, or ""."""
    bounds = shown.request.snapshot.bounds
    if bounds is None or bounds.contains(point[None])[0]:
        return ": scan more of what is there"
    if bounds.shape is RegionShape.BOX:
        return ", which lies outside of the region of interest: nothing there is scanned"
    centre = ", ".join(f"{value:.2f}" for value in bounds.centre)
    away, radius = float(np.linalg.norm(point - bounds.centre)), float(bounds.half_size[0])
    far = f", which lies {away:.2f} m from ({centre})"
    if shown.request.snapshot.memory is None:
        return (
            f"{far}, outside of the region of interest of {radius:.2f} m: nothing there is scanned"
        )
    return (
        f"{far}, outside of the work radius of {radius:.2f} m: nothing there is scanned; raise "
        "fusion.work_radius, or reset the scan and begin there"
    )


def _pixel_missed(shown: ShownMaterials, u: int, v: int) -> str:
    """The same for a pixel of the last frame."""
    frame = shown.request.frame
    if frame is None or not frame.depth[v, u] > 0.0:
        return ", which has no depth: what has none is background and is not scanned"
    camera, depth = frame.intrinsics, float(frame.depth[v, u])
    ray = np.array([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0])
    return _bounds_missed(shown, frame.T_world_camera[:3, :3] @ (depth * ray) + frame.camera_centre)
