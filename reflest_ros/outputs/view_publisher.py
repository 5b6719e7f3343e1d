# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A topic to look at: its message is made when someone looks, and not before."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from rclpy.event_handler import PublisherEventCallbacks, QoSPublisherMatchedInfo
from rclpy.node import Node

from reflest_ros.inputs.qos import OUTPUT_QOS

MakeMessage = Callable[[], Any]


class ViewPublisher:
    """Publishes messages to those who subscribe.

    Who subscribes later gets the last one at once: from DDS if it was published, else it is made
    then, in the executor's thread, which takes some 10 ms that the inputs wait in DDS.
    """

    def __init__(self, node: Node, message_type: type, topic: str) -> None:
        self._node = node
        self._lock = threading.Lock()
        self._unseen: MakeMessage | None = None
        self._publisher = node.create_publisher(
            message_type,
            topic,
            OUTPUT_QOS,
            event_callbacks=PublisherEventCallbacks(matched=self._on_matched),
        )

    def show(self, make: MakeMessage) -> None:
        """Publish what ``make`` returns; where nobody looks, keep ``make`` until someone does."""
        with self._lock:
            self._unseen = make
            if self._publisher.get_subscription_count() > 0:
                self._publish_unseen()

    def replace(self, message: Any) -> None:
        """Publish ``message`` in place of whatever was shown."""
        with self._lock:
            self._unseen = None
            self._publisher.publish(message)

    def destroy(self) -> None:
        """Give the publisher back."""
        self._node.destroy_publisher(self._publisher)

    def _on_matched(self, info: QoSPublisherMatchedInfo) -> None:
        with self._lock:
            if info.current_count_change > 0:
                self._publish_unseen()

    def _publish_unseen(self) -> None:
        if self._unseen is not None:
            self._publisher.publish(self._unseen())
            self._unseen = None
