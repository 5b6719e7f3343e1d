# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the viewer shows, out of the node's messages."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from sensor_msgs.msg import Image, PointCloud2

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
        ViewerError: The cloud is of another version of reflest.
        ExportError: The voxels make no surface yet, or a package is missing.
    """
    names = tuple(field.name for field in cloud.fields)
    kinds = {kind.itemsize: kind for kind in (POINT, far_points(POINT))}
    if names != POINT.names or cloud.point_step not in kinds or cloud.is_bigendian:
        raise ViewerError(
            "reflectance/material_cloud has other fields than this viewer reads: run node and "
            "viewer of one version"
        )
    points = np.frombuffer(bytes(cloud.data), kinds[cloud.point_step])
    if len(points) < 2 or not materials.materials:
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
    """
    shape = (radiance.height, radiance.width)
    image = np.ones((*shape, 5), np.float32)
    image[..., :3] = np.frombuffer(bytes(radiance.data), np.float32).reshape(*shape, 3)
    image[..., 4] = 0.0
    if coverage is not None and (coverage.height, coverage.width) == shape:
        image[..., 3] = np.frombuffer(bytes(coverage.data), np.uint8).reshape(shape) > 0
    directions = octahedral_directions(SIZE * ACROSS).reshape(-1, 3) @ rotation_to_z(up)
    cells = radiance_from(image, directions).reshape(SIZE, ACROSS, SIZE, ACROSS, 5)
    return np.asarray(cells.mean(axis=(1, 3)), np.float32)


def _columns(points: NDArray[np.void], *names: str) -> NDArray[Any]:
    return np.stack([points[name] for name in names], axis=-1)


def _material(message: Material) -> MaterialEstimate:
    return MaterialEstimate(
        message.id,
        estimate_from_message(message.estimate),
        (message.centroid.x, message.centroid.y, message.centroid.z),
        (message.extent.x, message.extent.y, message.extent.z),
        message.area,
        message.voxel_count,
        message.photometric_error,
    )
