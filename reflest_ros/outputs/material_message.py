# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Converts the core's material map to the messages of ROS."""

from __future__ import annotations

import math

import numpy as np
from geometry_msgs.msg import Point, Vector3
from sensor_msgs.msg import PointCloud2
from visualization_msgs.msg import Marker, MarkerArray

from reflest_core.estimation.estimate import SCHEMA_VERSION, EstimateStatus
from reflest_core.estimation.material_map import MaterialEstimate, MaterialMap
from reflest_core.inference.joint_light import JointLight
from reflest_core.rendering.material_labels import material_colour
from reflest_core.rendering.voxel_colours import observed_colours
from reflest_core.surface.partition import UNASSIGNED
from reflest_ros.inputs.core_messages import ns_to_stamp
from reflest_ros.msg import Material
from reflest_ros.msg import MaterialMap as MaterialMapMessage
from reflest_ros.outputs.estimate_message import estimate_to_message, unknown_message
from reflest_ros.outputs.point_cloud import far_points, packed_colours, point_cloud

POINT = np.dtype(
    [
        *[(name, np.float32) for name in ("x", "y", "z")],
        *[(f"normal_{axis}", np.float32) for axis in "xyz"],
        *[(f"rho_d_{channel}", np.float32) for channel in "rgb"],
        ("rho_s", np.float32),
        ("alpha", np.float32),
        *[(f"rho_d_{channel}_stddev", np.float32) for channel in "rgb"],
        ("rho_s_stddev", np.float32),
        ("alpha_stddev", np.float32),
        ("normal_stddev", np.float32),
        ("material_id", np.uint32),
        ("rgb", np.uint32),
        ("observed_rgb", np.uint32),
    ]
)
"""A point of ``reflectance/material_cloud``; ``rgb`` is the colour of the material's label,
``observed_rgb`` the mean of what the views saw, packed alike."""

TEXT_SHARE = 0.12
"""Height of a marker's text over the extent of its material."""


def material_to_message(material: MaterialEstimate) -> Material:
    """Convert a material.

    Args:
        material: Of a map.

    Returns:
        The message.
    """
    return Material(
        id=material.id,
        estimate=estimate_to_message(material.estimate),
        centroid=_point(material.centroid),
        extent=_vector(material.extent),
        area=material.area,
        voxel_count=material.voxel_count,
        photometric_error=material.photometric_error,
    )


def unknown_material() -> Material:
    """Make the message that stands for no material.

    Returns:
        A message whose estimate has STATUS_UNKNOWN.
    """
    return Material(estimate=unknown_message(), area=math.nan, photometric_error=math.nan)


def map_to_message(materials: MaterialMap, latency: float) -> MaterialMapMessage:
    """Convert a material map.

    Args:
        materials: The map.
        latency: Seconds from the keyframe's image or the request to now.

    Returns:
        The message.
    """
    light = materials.light
    joint = None if light is None else light.joint
    message = MaterialMapMessage(
        schema_version=SCHEMA_VERSION,
        materials=[material_to_message(one) for one in materials.materials],
        segment_count=materials.segment_count,
        voxel_count=int((materials.surface.observation_counts > 0).sum()),
        unassigned_voxel_count=int((materials.material_ids == UNASSIGNED).sum()),
        light_seen=math.nan if light is None else float(light.observed.coverage.mean()),
        light_stddev=math.nan if joint is None else _light_stddev(joint.light),
        light_condition=materials.light_condition,
        latency=latency,
    )
    message.header.stamp = ns_to_stamp(materials.stamp_ns)
    message.header.frame_id = materials.world_frame_id
    return message


def _light_stddev(light: JointLight) -> float:
    """The light's mean standard deviation over its mean radiance."""
    mean = float(light.light.levels[0][..., :3].mean())
    return float(light.deviation().mean()) / mean if mean > 0.0 else math.nan


def empty_map() -> MaterialMapMessage:
    """Make the map of a scan of which nothing is known.

    Returns:
        A message without materials.
    """
    return MaterialMapMessage(
        schema_version=SCHEMA_VERSION,
        light_seen=math.nan,
        light_stddev=math.nan,
        light_condition=math.nan,
        latency=math.nan,
    )


def map_to_cloud(materials: MaterialMap) -> PointCloud2:
    """Make the cloud of the observed voxels with their materials.

    Args:
        materials: The map.

    Returns:
        Points of the type :data:`POINT`, world frame, metres; NaN where a value is unknown. Their
        ``x``, ``y`` and ``z`` are float64 where the scan has an origin of its own.
    """
    surface = materials.surface
    observed = np.flatnonzero(surface.observation_counts > 0)
    points = np.zeros(len(observed), far_points(POINT) if surface.origin.any() else POINT)
    positions = surface.world_positions[observed]
    for axis, name in enumerate("xyz"):
        points[name] = positions[:, axis]
        points[f"normal_{name}"] = surface.normals[observed, axis]
    for axis, channel in enumerate("rgb"):
        points[f"rho_d_{channel}"] = materials.rho_d[observed, axis]
        points[f"rho_d_{channel}_stddev"] = materials.rho_d_stddev[observed, axis]
    for name in ("rho_s", "alpha", "rho_s_stddev", "alpha_stddev"):
        points[name] = materials.of_voxels(name)[observed]
    points["normal_stddev"] = materials.normal_stddev[observed]
    ids = materials.material_ids[observed]
    points["material_id"] = ids
    present, places = np.unique(ids, return_inverse=True)
    colours = np.array([material_colour(int(one)) for one in present], np.uint8).reshape(-1, 3)
    points["rgb"] = packed_colours(colours)[places]
    points["observed_rgb"] = packed_colours(observed_colours(surface)[observed])
    return point_cloud(points, materials.world_frame_id, materials.stamp_ns, is_dense=False)


def map_to_markers(materials: MaterialMap) -> MarkerArray:
    """Make a text at each material, in its label's colour and fainter where it is uncertain.

    Args:
        materials: The map.

    Returns:
        The markers, after one that removes those of earlier maps.
    """
    markers = [Marker(action=Marker.DELETEALL)]
    for one in materials.materials:
        marker = Marker(ns="materials", id=one.id, type=Marker.TEXT_VIEW_FACING)
        marker.header.stamp = ns_to_stamp(materials.stamp_ns)
        marker.header.frame_id = materials.world_frame_id
        marker.pose.position = _point(one.centroid)
        marker.pose.orientation.w = 1.0
        marker.scale.z = max(TEXT_SHARE * max(one.extent), 0.005)
        red, green, blue = material_colour(one.id)
        marker.color.r, marker.color.g, marker.color.b = red / 255, green / 255, blue / 255
        marker.color.a = 1.0 if one.estimate.status is EstimateStatus.OK else 0.6
        estimate = one.estimate
        marker.text = (
            f"{one.id}: rho_s {estimate.rho_s:.3f}  alpha {estimate.alpha:.3f}\n"
            f"{estimate.status.name}"
        )
        markers.append(marker)
    return MarkerArray(markers=markers)


def _point(position: tuple[float, float, float]) -> Point:
    x, y, z = map(float, position)
    return Point(x=x, y=y, z=z)


def _vector(edges: tuple[float, float, float]) -> Vector3:
    x, y, z = map(float, edges)
    return Vector3(x=x, y=y, z=z)
