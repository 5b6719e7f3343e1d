# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflectance/environment``: the light around the object, with what of it was seen."""

from __future__ import annotations

from functools import cache

from rclpy.node import Node
from sensor_msgs.msg import Image

from reflest_core.environment.environment_map import EnvironmentMap, environment_map, nothing_seen
from reflest_core.environment.picture import coverage_codes, tone_mapped
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.pipeline import KeyframeSnapshot
from reflest_ros.outputs.pixels import pixels_message
from reflest_ros.outputs.view_publisher import ViewPublisher
from reflest_ros.outputs.view_settings import EnvironmentSettings, read_settings

TOPIC = "reflectance/environment"


class Environment:
    """Publishes three images; see :class:`reflest_ros.outputs.estimate_output.EstimateView`."""

    def __init__(self, node: Node) -> None:
        """Create the publishers.

        Args:
            node: publishes.
        """
        self._node = node
        self._radiance = ViewPublisher(node, Image, TOPIC)
        self._coverage = ViewPublisher(node, Image, f"{TOPIC}/coverage")
        self._preview = ViewPublisher(node, Image, f"{TOPIC}/preview")
        self._frame_id = ""

    def show(self, keyframe: KeyframeSnapshot, estimate: BrdfEstimate | None) -> None:
        """Show the light at a keyframe.

        Args:
            keyframe: the scan that it belongs to.
            estimate: the keyframe's estimate; None where there is none.
        """
        frame_id = self._frame_id = keyframe.world_frame_id
        stamp_ns = keyframe.stamp_ns
        height = read_settings(self._node, "environment", EnvironmentSettings).height

        # Three topics show one map, which is made when the first of them is looked at.
        @cache
        def made() -> EnvironmentMap:
            return environment_map(keyframe.surface, height)

        self._radiance.show(lambda: radiance_message(made(), frame_id, stamp_ns))
        self._coverage.show(lambda: coverage_message(made(), frame_id, stamp_ns))
        self._preview.show(lambda: preview_message(made(), frame_id, stamp_ns))

    def clear(self) -> None:
        """Replace the last light, which stays readable, by one of which nothing was seen."""
        empty = nothing_seen(read_settings(self._node, "environment", EnvironmentSettings).height)
        self._radiance.replace(radiance_message(empty, self._frame_id, 0))
        self._coverage.replace(coverage_message(empty, self._frame_id, 0))
        self._preview.replace(preview_message(empty, self._frame_id, 0))

    def destroy(self) -> None:
        """Destroy the publishers."""
        for publisher in (self._radiance, self._coverage, self._preview):
            publisher.destroy()


def radiance_message(environment: EnvironmentMap, frame_id: str, stamp_ns: int) -> Image:
    """``32FC3``: red, green, blue of :attr:`EnvironmentMap.radiance`.

    Args:
        environment: the light to publish.
        frame_id: of the header.
        stamp_ns: of the header, nanoseconds.
    """
    return pixels_message(environment.radiance, "32FC3", frame_id, stamp_ns)


def coverage_message(environment: EnvironmentMap, frame_id: str, stamp_ns: int) -> Image:
    """``mono8``: :func:`.coverage_codes`.

    Args:
        environment: the light to publish.
        frame_id: of the header.
        stamp_ns: of the header, nanoseconds.
    """
    return pixels_message(coverage_codes(environment), "mono8", frame_id, stamp_ns)


def preview_message(environment: EnvironmentMap, frame_id: str, stamp_ns: int) -> Image:
    """``rgb8``: :func:`.tone_mapped`.

    Args:
        environment: the light to publish.
        frame_id: of the header.
        stamp_ns: of the header, nanoseconds.
    """
    return pixels_message(tone_mapped(environment), "rgb8", frame_id, stamp_ns)
