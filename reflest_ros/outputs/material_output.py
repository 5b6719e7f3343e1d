# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The topics of the materials, and the map that ``~/material_at`` answers from."""

from __future__ import annotations

import math
import time
import traceback
from dataclasses import dataclass

import numpy as np
from rclpy.node import Node
from sensor_msgs.msg import Image, PointCloud2
from visualization_msgs.msg import Marker, MarkerArray

from reflest_core.capture.frame import Frame
from reflest_core.errors import ReflestError
from reflest_core.estimation.material_map import MaterialMap
from reflest_core.estimation.pipeline import KeyframeSnapshot
from reflest_core.rendering.material_labels import CameraView, labels_over, voxels_in_image
from reflest_ros.inputs.qos import OUTPUT_QOS
from reflest_ros.msg import MaterialMap as MaterialMapMessage
from reflest_ros.outputs.material_message import (
    POINT,
    empty_map,
    map_to_cloud,
    map_to_markers,
    map_to_message,
)
from reflest_ros.outputs.pixels import pixels_message
from reflest_ros.outputs.point_cloud import point_cloud
from reflest_ros.outputs.view_publisher import ViewPublisher
from reflest_ros.outputs.view_settings import MaterialSettings, read_settings

TOPIC = "reflectance/materials"


@dataclass(frozen=True)
class MaterialRequest:
    """What a material map is made of.

    Attributes:
        snapshot: The scan.
        frame: The last frame that was fused; None where there is none yet.
        voxel_size: Edge of a voxel of the scan, metres.
        asked: ``time.monotonic`` of the request.
    """

    snapshot: KeyframeSnapshot
    frame: Frame | None
    voxel_size: float
    asked: float


@dataclass(frozen=True)
class ShownMaterials:
    """A material map with what it was made of.

    Attributes:
        materials: The map.
        request: What it was made of.
    """

    materials: MaterialMap
    request: MaterialRequest

    @property
    def view(self) -> CameraView | None:
        """The camera of the last frame in the surface's coordinates, None where there is none."""
        frame = self.request.frame
        return None if frame is None else _view(frame, self.materials)


class MaterialOutput:
    """Publishes material maps; the estimation worker runs one of its methods at a time.

    Attributes:
        latest: The map that was published last, None after a reset.
        published: Maps that were published.
        failure: Why the last one could not be made, or "".
        duration: Seconds that the last one took.
    """

    def __init__(self, node: Node) -> None:
        """Create the publishers.

        Args:
            node: The node.
        """
        self.latest: ShownMaterials | None = None
        self.published = 0
        self.failure = ""
        self.duration = float("nan")
        self._node = node
        self._map = node.create_publisher(MaterialMapMessage, TOPIC, OUTPUT_QOS)
        self._cloud = ViewPublisher(node, PointCloud2, "reflectance/material_cloud")
        self._markers = ViewPublisher(node, MarkerArray, "reflectance/material_markers")
        self._overlay = ViewPublisher(node, Image, "reflectance/overlay")

    @property
    def count(self) -> int:
        """Materials of the latest map."""
        return 0 if self.latest is None else len(self.latest.materials.materials)

    @property
    def details(self) -> dict[str, str]:
        """What the diagnostics say of the latest map: its segments, its light, and its stages."""
        found = None if self.latest is None else self.latest.materials
        seconds = {} if found is None else found.seconds
        return {
            "segments": "0" if found is None else str(found.segment_count),
            "light's condition": f"{math.nan if found is None else found.light_condition:.1f}",
            **{
                f"time of {stage} (s)": f"{seconds.get(stage, math.nan):.3f}"
                for stage in ("segmentation", "light", "materials")
            },
        }

    @property
    def is_wanted(self) -> bool:
        """Whether a map is to be made at keyframes."""
        when = read_settings(self._node, "materials", MaterialSettings).when
        if when != "subscribed":
            return when == "always"
        return self._map.get_subscription_count() > 0 or any(
            view.is_watched for view in (self._cloud, self._markers, self._overlay)
        )

    def publish(self, request: MaterialRequest, materials: MaterialMap) -> None:
        """Send a map on all topics.

        Args:
            request: What it was made of.
            materials: The map.
        """
        shown = ShownMaterials(materials, request)
        self.duration = time.monotonic() - request.asked
        self._map.publish(map_to_message(materials, self.duration))
        self.latest, self.failure = shown, ""
        self.published += 1
        self._cloud.show(lambda: map_to_cloud(materials))
        self._markers.show(lambda: map_to_markers(materials))
        if request.frame is not None:
            frame = request.frame
            self._overlay.show(lambda: overlay_message(shown, frame))

    def fail(self, error: Exception) -> None:
        """Note why a map could not be made; each reason is logged once.

        Args:
            error: The reason.
        """
        reason = str(error) if isinstance(error, ReflestError) else repr(error)
        if reason != self.failure:
            log = self._node.get_logger()
            if isinstance(error, ReflestError):
                log.warning(f"no materials at a keyframe: {reason}")
            else:
                log.error("".join(traceback.format_exception(error)).rstrip())
        self.failure = reason

    def clear(self) -> None:
        """Replace what was published by an empty map and a black overlay: a new scan begins."""
        last, self.latest = self.latest, None
        world = "" if last is None else last.materials.world_frame_id
        self._map.publish(empty_map())
        self._cloud.replace(point_cloud(np.zeros(0, POINT), world, 0, is_dense=False))
        if last is not None and (frame := last.request.frame) is not None:
            empty = np.zeros_like(frame.rgb)
            self._overlay.replace(pixels_message(empty, "rgb8", frame.frame_id, 0))
        self._markers.replace(MarkerArray(markers=[Marker(action=Marker.DELETEALL)]))

    def destroy(self) -> None:
        """Destroy the publishers."""
        self._node.destroy_publisher(self._map)
        for view in (self._cloud, self._markers, self._overlay):
            view.destroy()


def overlay_message(shown: ShownMaterials, frame: Frame) -> Image:
    """Draw the materials over an image; what is outside of the scan's bounds is dark.

    Args:
        shown: The map.
        frame: Its image, depth, calibration and pose.

    Returns:
        An ``rgb8`` image of the frame's size, stamp and camera frame.
    """
    materials, request = shown.materials, shown.request
    view = _view(frame, materials)
    voxels = voxels_in_image(materials.surface.positions, view, request.voxel_size)
    bounds = request.snapshot.bounds
    is_scanned = None if bounds is None else bounds.shows(frame)
    drawn = labels_over(frame.rgb, voxels, materials.material_ids, is_scanned)
    return pixels_message(drawn, "rgb8", frame.frame_id, frame.stamp_ns)


def _view(frame: Frame, materials: MaterialMap) -> CameraView:
    """The camera in the coordinates of a map's surface."""
    frame = frame.relative_to(materials.surface.origin)
    return CameraView(frame.intrinsics, frame.T_world_camera)
