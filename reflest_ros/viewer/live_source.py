# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The node's latched topics and its services as a source of the page."""

from __future__ import annotations

import threading
import time
from dataclasses import replace
from typing import Any

import numpy as np
from geometry_msgs.msg import Point, Vector3
from numpy.typing import NDArray
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from sensor_msgs.msg import Image, PointCloud2
from std_srvs.srv import Trigger

from reflest_core.errors import ReflestError
from reflest_core.viewer.source import FORMATS, Outcome, SourceState, ViewerError
from reflest_ros.inputs.core_messages import stamp_to_ns
from reflest_ros.inputs.qos import OUTPUT_QOS
from reflest_ros.msg import MaterialMap as MaterialMapMessage
from reflest_ros.srv import ExportEstimate, SaveScan, SetRegion
from reflest_ros.viewer.received_scan import received_light, received_scan

ANSWER_S = 120.0
"""Seconds in which a service must answer: an export of a large scan takes a while."""
FOUND_S = 2.0
"""Seconds in which a service must be there."""
REST = 4.0
"""Times as long as a surface took to make, the viewer rests: processors are for the estimator."""
CHECK_S = 0.25
"""Seconds between looks for a map that waits."""


SERVICES = {"set_region": SetRegion, "reset": Trigger, "save": SaveScan, "export": ExportEstimate}


class LiveSource:
    """Shows what a node published last, and calls its services.

    The callbacks run in the thread of an executor, everything else in those of the page.
    """

    def __init__(self, node: Node, estimator: str, up: tuple[float, float, float]) -> None:
        """Subscribe.

        Args:
            node: of the viewer; an executor in another thread spins it.
            estimator: name of the estimator's node, in the viewer's namespace or from the root.
            up: direction that points up in the world frame.
        """
        self._node, self._estimator, self.up = node, estimator, up
        self.name = f"{node.get_namespace().rstrip('/')}/{estimator.lstrip('/')}"
        self._group = ReentrantCallbackGroup()
        self._state = SourceState(
            progress=f"waiting for the materials of {self.name}", is_working=True
        )
        self._materials: MaterialMapMessage | None = None
        self._cloud: PointCloud2 | None = None
        self._images: dict[str, Image] = {}
        self._light: NDArray[np.float32] | None = None
        self._services: dict[str, Any] = {}
        self._lock = threading.Lock()
        self._is_due, self._free_at = False, 0.0
        self._warning = ""
        node.create_timer(CHECK_S, self._make_due)
        for kind, topic, take in (
            (MaterialMapMessage, "materials", self._take_materials),
            (PointCloud2, "material_cloud", self._take_cloud),
            (Image, "environment", self._take_radiance),
            (Image, "environment/coverage", self._take_coverage),
        ):
            node.create_subscription(kind, f"reflectance/{topic}", take, OUTPUT_QOS)

    @property
    def services(self) -> tuple[str, ...]:
        """Names of the services that are called."""
        return tuple(f"{self._estimator}/{name}" for name in SERVICES)

    @property
    def can_rescan(self) -> bool:
        """True: the node takes another region at any time."""
        return True

    def state(self) -> SourceState:
        """What the node published last."""
        return self._state

    def set_region(self, centre: tuple[float, float, float], radius: float) -> Outcome:
        """Ask the node to scan a sphere.

        Args:
            centre: world frame, metres.
            radius: metres.

        Raises:
            ViewerError: The node does not answer, or refuses.
        """
        x, y, z = centre
        edge = 2.0 * radius
        request = SetRegion.Request(
            shape=SetRegion.Request.SHAPE_SPHERE,
            centre=Point(x=x, y=y, z=z),
            size=Vector3(x=edge, y=edge, z=edge),
        )
        return self._call("set_region", request)

    def reset(self) -> Outcome:
        """Ask the node to begin a new scan.

        Raises:
            ViewerError: The node does not answer, or refuses.
        """
        return self._call("reset", Trigger.Request())

    def save(self) -> Outcome:
        """Ask the node to save its scan, below its ``files.root``.

        Raises:
            ViewerError: The node does not answer, or refuses.
        """
        return self._call("save", SaveScan.Request(path=_file_name(".reflest")))

    def export(self, format_name: str) -> Outcome:
        """Ask the node to export its surface, below its ``files.root``.

        Args:
            format_name: a key of :data:`~reflest_core.viewer.source.FORMATS`.

        Raises:
            ViewerError: The node does not answer, or refuses.
        """
        path = _file_name(FORMATS[format_name])
        request = ExportEstimate.Request(format=format_name, path=path)
        return self._call("export", request)

    def close(self) -> None:
        """Nothing: the node's owner ends it."""

    def _call(self, name: str, request: Any) -> Outcome:
        with self._lock:
            if name not in self._services:
                self._services[name] = self._node.create_client(
                    SERVICES[name], f"{self._estimator}/{name}", callback_group=self._group
                )
            client = self._services[name]
        if not client.wait_for_service(FOUND_S):
            raise ViewerError(f"there is no service {client.srv_name}: start the estimator")
        answered = threading.Event()
        future = client.call_async(request)
        future.add_done_callback(lambda _: answered.set())
        if not answered.wait(ANSWER_S):
            client.remove_pending_request(future)
            raise ViewerError(f"{client.srv_name} did not answer in {ANSWER_S:g} s")
        response = future.result()
        if not response.success:
            raise ViewerError(response.message)
        return Outcome(response.message)

    def _take_materials(self, message: MaterialMapMessage) -> None:
        self._materials = message
        self._combine()

    def _take_cloud(self, message: PointCloud2) -> None:
        self._cloud = message
        self._combine()

    def _take_radiance(self, message: Image) -> None:
        self._images["radiance"] = message
        self._take_light()

    def _take_coverage(self, message: Image) -> None:
        self._images["coverage"] = message
        self._take_light()

    def _take_light(self) -> None:
        radiance = self._images.get("radiance")
        if radiance is None or not radiance.data or not stamp_to_ns(radiance.header.stamp):
            self._light = None
            return
        try:
            self._light = received_light(radiance, self._images.get("coverage"), self.up)
        except ReflestError as error:
            self._warn(str(error))

    def _combine(self) -> None:
        """Show map and cloud once both are of one keyframe; an empty map clears the page."""
        materials, cloud = self._materials, self._cloud
        if materials is None or not materials.materials:
            self._is_due = False
            self._state = SourceState(
                progress=f"{self.name} has no materials yet: scan on", is_working=True
            )
            return
        self._is_due = cloud is not None and cloud.header.stamp == materials.header.stamp
        self._make_due()

    def _make_due(self) -> None:
        """Make the surface of the last map, unless the viewer rests."""
        materials, cloud, began = self._materials, self._cloud, time.monotonic()
        if not self._is_due or materials is None or cloud is None or began < self._free_at:
            return
        self._is_due = False
        try:
            scan = received_scan(materials, cloud, self._light, self.up)
        except ReflestError as error:
            self._warn(str(error))
            return
        finally:
            ended = time.monotonic()
            self._free_at = ended + REST * (ended - began)
        self._warning = ""
        count = len(materials.materials)
        seconds = stamp_to_ns(materials.header.stamp) / 1e9
        self._state = SourceState(
            scan,
            (),
            f"{count} material{'s' if count != 1 else ''}, {materials.voxel_count:,} voxels, "
            f"keyframe at {seconds:.2f} s",
            1.0,
        )

    def _warn(self, sentence: str) -> None:
        """Say why the last message is not shown, below the picture that was shown before it."""
        self._state = replace(self._state, progress=sentence)
        if sentence != self._warning:
            self._node.get_logger().warning(sentence)
        self._warning = sentence


def _file_name(suffix: str) -> str:
    return time.strftime("viewer_%Y%m%d_%H%M%S") + suffix
