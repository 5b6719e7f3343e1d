# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflectance/preview``: a sphere of the estimated material under a fixed light."""

from __future__ import annotations

import numpy as np
from rclpy.node import Node
from sensor_msgs.msg import Image

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.pipeline import KeyframeSnapshot
from reflest_core.rendering.sphere import render_point_light, tone_map
from reflest_ros.outputs.pixels import pixels_message
from reflest_ros.outputs.view_publisher import ViewPublisher
from reflest_ros.outputs.view_settings import PreviewSettings, read_settings

LIGHT = (-0.45, -0.8, 0.6)
"""Direction towards the light: above and left of the camera, which looks along +y with z up."""

EXPOSURE = 0.9
"""So that a white diffuse sphere is not clipped; highlights are."""


class Preview:
    """Publishes the sphere; see :class:`reflest_ros.outputs.estimate_output.EstimateView`."""

    def __init__(self, node: Node) -> None:
        """Create the publishers.

        Args:
            node: publishes.
        """
        self._node = node
        self._publisher = ViewPublisher(node, Image, "reflectance/preview")
        self._frame_id = ""

    def show(self, keyframe: KeyframeSnapshot, estimate: BrdfEstimate | None) -> None:
        """Show the sphere of an estimate.

        Args:
            keyframe: the scan that it belongs to.
            estimate: the keyframe's estimate.
        """
        if estimate is not None:
            self._frame_id = estimate.frame_id
            self._publisher.show(lambda: preview_message(estimate, self._settings.size))

    def clear(self) -> None:
        """Replace the last sphere, which stays readable, by a black picture."""
        size = self._settings.size
        empty = np.zeros((size, size, 3), np.uint8)
        self._publisher.replace(pixels_message(empty, "rgb8", self._frame_id, 0))

    def destroy(self) -> None:
        """Destroy the publisher."""
        self._publisher.destroy()

    @property
    def _settings(self) -> PreviewSettings:
        return read_settings(self._node, "preview", PreviewSettings)


def preview_message(estimate: BrdfEstimate, size: int) -> Image:
    """An ``rgb8`` image (size, size), sRGB, with the estimate's stamp and camera frame.

    Args:
        estimate: the keyframe's estimate.
        size: pixels along an edge.
    """
    picture = tone_map(render_point_light(estimate.ward, LIGHT, size), EXPOSURE)
    return pixels_message(picture, "rgb8", estimate.frame_id, estimate.stamp_ns)
