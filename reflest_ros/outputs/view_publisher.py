# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A topic for displays: its message is made when someone subscribes, and not before."""

from __future__ import annotations

import threading
import traceback
from collections.abc import Callable
from typing import Any

from rclpy.event_handler import PublisherEventCallbacks, QoSPublisherMatchedInfo
from rclpy.node import Node

from reflest_ros.inputs.qos import OUTPUT_QOS

MakeMessage = Callable[[], Any]


class ViewPublisher:
    """Publishes messages to subscribers.

    A late subscriber gets the last one at once: from DDS if it was published, else it is made then,
    in the executor's thread, which takes some 10 ms that the inputs wait in DDS.
    """

    def __init__(self, node: Node, message_type: type, topic: str) -> None:
        """Create the publisher.

        Args:
            node: The node.
            message_type: Of the topic.
            topic: Its relative name.
        """
        self._node = node
        self._lock = threading.Lock()
        self._unseen: MakeMessage | None = None
        self._publisher = node.create_publisher(
            message_type,
            topic,
            OUTPUT_QOS,
            event_callbacks=PublisherEventCallbacks(matched=self._on_matched),
        )

    @property
    def is_watched(self) -> bool:
        """Whether anyone subscribes."""
        return bool(self._publisher.get_subscription_count() > 0)

    def show(self, make: MakeMessage) -> None:
        """Publish a message; without a subscriber, keep what makes it until there is one.

        Args:
            make: Makes the message.
        """
        with self._lock:
            self._unseen = make
            if self.is_watched:
                self._publish_unseen()

    def replace(self, message: Any) -> None:
        """Publish a message in place of the last one.

        Args:
            message: The message.
        """
        with self._lock:
            self._unseen = None
            self._publisher.publish(message)

    def destroy(self) -> None:
        """Destroy the publisher."""
        self._node.destroy_publisher(self._publisher)

    def _on_matched(self, info: QoSPublisherMatchedInfo) -> None:
        with self._lock:
            if info.current_count_change > 0:
                try:
                    self._publish_unseen()
                except Exception as error:  # the executor would end with it
                    trace = "".join(traceback.format_exception(error)).rstrip()
                    self._node.get_logger().error(f"{self._publisher.topic_name}: {trace}")

    def _publish_unseen(self) -> None:
        if self._unseen is not None:
            self._publisher.publish(self._unseen())
            self._unseen = None
