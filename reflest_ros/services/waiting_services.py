# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The services that wait for fusion, on a hidden node beside the estimator's.

The estimator's executor has one thread, which must go on receiving: rclpy's other executors spend
more on every message than fusion does.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.service import Service

from reflest_ros.spinning import Spinning

THREADS = 2
"""Services that may wait at once."""


class WaitingServices:
    """Offers services under the estimator's own names, answered in threads of their own."""

    def __init__(self, owner: Node, on_crash: Callable[[BaseException], None]) -> None:
        self._owner = owner
        # Its own name and no global arguments, or a remapping of the estimator's name takes both.
        self._node = Node(
            f"_{owner.get_name()}_services",
            namespace=owner.get_namespace(),
            context=owner.context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._group = ReentrantCallbackGroup()
        executor = MultiThreadedExecutor(THREADS, context=owner.context)
        executor.add_node(self._node)
        self._spinning = Spinning(executor, "services", on_crash)

    @property
    def services(self) -> list[Service[Any, Any]]:
        """What :meth:`create` made."""
        return list(self._node.services)

    def create(self, service_type: type, name: str, answer: Callable[[Any, Any], Any]) -> None:
        """Offer the service ``name``, relative to the estimator."""
        full_name = self._owner.resolve_service_name(name)
        self._node.create_service(service_type, full_name, answer, callback_group=self._group)

    def start(self) -> None:
        """Begin to answer."""
        self._spinning.start()

    def close(self) -> None:
        """Take the services away, after the answers in hand."""
        self._spinning.stop()
        self._node.destroy_node()
