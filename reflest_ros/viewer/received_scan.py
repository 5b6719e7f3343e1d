# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the viewer shows, out of the node's messages."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from sensor_msgs.msg import Image, PointCloud2

from reflest_core.capture.pose import FURTHEST
from reflest_core.estimation.material_map import MaterialEstimate, MaterialMap
from reflest_core.light.equirectangular import radiance_from
from reflest_core.light.light_map import SIZE
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.partition import Partition
from reflest_core.surface.upright import rotation_to_z
from reflest_core.viewer.shown_scan import ShownScan
from reflest_core.viewer.source import ViewerError
from reflest_ros.inputs.core_messages import stamp_to_ns
from reflest_ros.msg import Material
from reflest_ros.msg import MaterialMap as MaterialMapMessage
from reflest_ros.outputs.estimate_message import estimate_from_message
from reflest_ros.outputs.material_message import POINT
from reflest_ros.outputs.point_cloud import far_points

MEASURED = 2000
"""Points whose distance to the nearest one is measured."""
ACROSS = 2
"""Directions along each edge of a texel of the light that are averaged."""


def received_scan(
    materials: MaterialMapMessage,
    cloud: PointCloud2,
    light: NDArray[np.float32] | None,
    up: tuple[float, float, float],
) -> ShownScan | None:
    """Make the scan that the page shows.

    Args:
        materials: of ``reflectance/materials``.
        cloud: of ``reflectance/material_cloud``, of the same keyframe.
        light: of :func:`received_light`.
        up: direction that points up in the world frame.

    Returns:
        The scan; None where nothing was scanned.

    Raises:
        ViewerError: Map or cloud are damaged, or of another version of reflest.
        ExportError: The voxels make no surface yet, or a package is missing.
    """
    points = _points(cloud)
    if not len(points) or not materials.materials:
        return None
    positions, nothing = _columns(points, "x", "y", "z"), np.zeros((0, 3), np.float32)
    is_far = positions.dtype == np.float64
    # In whole hectometres, so that the page's coordinates stay as the scan grows.
    origin = 100.0 * np.round(positions.mean(axis=0) / 100.0) if is_far else np.zeros(3)
    positions = (positions - origin).astype(np.float32) if is_far else positions
    surface = ObservedSurface(
        positions,
        _columns(points, "normal_x", "normal_y", "normal_z"),
        np.zeros(len(points) + 1, np.int64),
        np.zeros((0, 3), np.uint8),
        np.zeros(0, np.uint16),
        nothing,
        nothing,
        nothing,
        origin=origin,
    )
    found = MaterialMap(
        stamp_to_ns(materials.header.stamp),
        "",
        surface,
        Partition.of(surface, points["material_id"]),
        tuple(_material(one) for one in materials.materials),
        _columns(points, "rho_d_r", "rho_d_g", "rho_d_b"),
        _columns(points, "rho_d_r_stddev", "rho_d_g_stddev", "rho_d_b_stddev"),
        world_frame_id=materials.header.frame_id,
    )
    every = max(len(points) // MEASURED, 1)
    distances, _ = cKDTree(positions).query(positions[::every], k=2)
    packed = points["observed_rgb"]
    colours = np.stack([packed >> 16 & 255, packed >> 8 & 255, packed & 255], axis=1)
    voxel_size = float(np.median(distances[:, 1]))
    if not 0.0 < voxel_size < np.inf:
        raise ViewerError(f"the {len(points)} points of reflectance/material_cloud are no surface")
    return ShownScan.of_voxels(found, up, voxel_size, light, colours.astype(np.uint8))


def received_light(
    radiance: Image, coverage: Image | None, up: tuple[float, float, float]
) -> NDArray[np.float32]:
    """The light as the estimator has it.

    Args:
        radiance: of ``reflectance/environment``.
        coverage: of ``reflectance/environment/coverage``; None takes all for seen.
        up: direction that points up in the world frame.

    Returns:
        (SIZE, SIZE, 5) octahedral, turned so that up is +z.

    Raises:
        ViewerError: An image is damaged.
    """
    shape = (radiance.height, radiance.width)
    image = np.ones((*shape, 5), np.float32)
    image[..., :3] = _pixels(radiance, "", np.dtype((np.float32, 3)))
    image[..., 4] = 0.0
    if not np.isfinite(image).all():
        raise ViewerError("reflectance/environment holds values that are not finite")
    if coverage is not None and (coverage.height, coverage.width) == shape:
        image[..., 3] = _pixels(coverage, "/coverage", np.dtype(np.uint8)) > 0
    directions = octahedral_directions(SIZE * ACROSS).reshape(-1, 3) @ rotation_to_z(up)
    cells = radiance_from(image, directions).reshape(SIZE, ACROSS, SIZE, ACROSS, 5)
    return np.asarray(cells.mean(axis=(1, 3)), np.float32)


def _points(cloud: PointCloud2) -> NDArray[np.void]:
    """The records of a cloud, all with finite places and normals."""
    names = tuple(field.name for field in cloud.fields)
    kinds = {kind.itemsize: kind for kind in (POINT, far_points(POINT))}
    if names != POINT.names or cloud.point_step not in kinds or cloud.is_bigendian:
        raise ViewerError(
            "reflectance/material_cloud has other fields than this viewer reads: run node and "
            "viewer of one version"
        )
    size = cloud.width * cloud.height * cloud.point_step
    if len(cloud.data) != size:
        raise ViewerError(
            f"reflectance/material_cloud holds {len(cloud.data)} of {size} bytes: it was damaged "
            "on the way"
        )
    points = np.frombuffer(bytes(cloud.data), kinds[cloud.point_step])
    normals = _columns(points, "normal_x", "normal_y", "normal_z")
    is_near = np.abs(_columns(points, "x", "y", "z")) < FURTHEST  # False for NaN too
    if not (is_near.all() and np.isfinite(normals).all()):
        raise ViewerError(
            "reflectance/material_cloud holds points that are not finite, or farther away than "
            f"{FURTHEST:.0e} m"
        )
    return points


def _pixels(image: Image, below: str, kind: np.dtype[Any]) -> NDArray[Any]:
    """(H, W, ...) pixels of an image of the light."""
    size = image.height * image.width * kind.itemsize
    if not size or len(image.data) != size:
        raise ViewerError(
            f"reflectance/environment{below} holds {len(image.data)} bytes where {image.width} x "
            f"{image.height} pixels have {size}: it was damaged on the way"
        )
    shape = (image.height, image.width, *kind.shape)
    return np.frombuffer(bytes(image.data), kind.base).reshape(shape)


def _columns(points: NDArray[np.void], *names: str) -> NDArray[Any]:
    return np.stack([points[name] for name in names], axis=-1)


def _material(message: Material) -> MaterialEstimate:
    try:
        estimate = estimate_from_message(message.estimate)
    except ValueError as error:
        raise ViewerError(
            f"reflectance/materials has an estimate that this viewer cannot read ({error}): run "
            "node and viewer of one version"
        ) from error
    return MaterialEstimate(
        message.id,
        estimate,
        (message.centroid.x, message.centroid.y, message.centroid.z),
        (message.extent.x, message.extent.y, message.extent.z),
        message.area,
        message.voxel_count,
        message.photometric_error,
    )
