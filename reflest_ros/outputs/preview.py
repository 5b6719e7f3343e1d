# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflectance/preview``: a sphere of the estimated material under a fixed light."""

from __future__ import annotations

import array

from rclpy.node import Node
from sensor_msgs.msg import Image

from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.pipeline import KeyframeSnapshot
from reflest_core.rendering.sphere import render_point_light, tone_map
from reflest_ros.inputs.core_messages import ns_to_stamp
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

    def show(self, keyframe: KeyframeSnapshot, estimate: BrdfEstimate | None) -> None:
        """Show the sphere of an estimate.

        Args:
            keyframe: the scan that it belongs to.
            estimate: the keyframe's estimate.
        """
        if estimate is not None:
            self._publisher.show(lambda: preview_message(estimate, self._settings.size))

    def clear(self) -> None:
        """Leave the sphere: like the estimate on its topic, it holds until the next one."""

    def destroy(self) -> None:
        """Give the publisher back."""
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
    message = Image(height=size, width=size, encoding="rgb8", is_bigendian=0, step=3 * size)
    message.header.stamp = ns_to_stamp(estimate.stamp_ns)
    message.header.frame_id = estimate.frame_id
    message.data = array.array("B", picture.tobytes())
    return message
