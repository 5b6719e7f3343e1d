# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What best effort loses between two processes is counted and warned of, with the fix."""

from __future__ import annotations

from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image
from sphere_messages import RGB, rgb_message
from sphere_scene import views

BURST = 20
MOST_BURSTS = 100


def test_images_that_are_lost_on_the_way_are_counted(start, settings_file, peer):
    """With Fast DDS' own half megabyte of shared memory, a burst of large images is too much."""
    node = start(
        "reflest_ros.estimator",
        "--ros-args",
        "--params-file",
        settings_file,
        "-p",
        "input.reliability:=best_effort",
        FASTRTPS_DEFAULT_PROFILES_FILE="",
    )
    node.wait_for_line("listening to", 600.0)
    qos = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    output = peer.offer(Image, RGB, qos)
    peer.wait_until(lambda: output.get_subscription_count() > 0, "no subscriber")
    small = rgb_message(next(views(1)))
    image = rgb_message(next(views(1)))
    image.height, image.step = 10 * image.height, 10 * image.step
    image.data = 100 * image.data
    output.publish(small)
    peer.wait_for_count("messages rgb", 1)
    for _ in range(MOST_BURSTS):
        for _ in range(BURST):
            output.publish(image)
        if peer.count("refused message_lost") > 0:
            break

    def is_told() -> bool:
        """A loss shows when a later image comes through; a small one does."""
        output.publish(small)
        return peer.count("refused message_lost") > 0

    peer.wait_until(is_told, "no loss was counted")
    warning = node.wait_for_line(r"\(cause: message_lost; logged once\)")
    for words in (RGB, "config/fastdds_large_messages.xml", "input.reliability"):
        assert words in warning
    assert node.is_running
