# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``ros2 run reflest_ros viewer``: the page of a running estimator."""

from __future__ import annotations

import contextlib
import os
import sys
import threading

from rclpy.executors import MultiThreadedExecutor, ShutdownException
from rclpy.node import Node

from reflest_core.errors import ReflestError
from reflest_core.export.libraries import library
from reflest_core.viewer.server import LOOPBACK, PORT, ViewerServer, serve
from reflest_core.viewer.source import ViewerError
from reflest_ros.process import ros_process
from reflest_ros.settings import NODE_NAME
from reflest_ros.viewer.live_source import LiveSource

NICE = 10
"""Of the viewer's process: where processors are scarce, the estimator goes first."""


class ViewerNode(Node):
    """Holds the viewer's parameters: ``host``, ``port``, ``estimator``, ``up``."""

    def __init__(self) -> None:
        """Declare them."""
        super().__init__("reflest_viewer")
        self.declare_parameter("host", LOOPBACK)
        self.declare_parameter("port", PORT)
        self.declare_parameter("estimator", NODE_NAME)
        self.declare_parameter("up", [0.0, 0.0, 1.0])

    @property
    def up(self) -> tuple[float, float, float]:
        """Direction that points up in the world frame.

        Raises:
            ViewerError: It is no direction.
        """
        given = list(self.get_parameter("up").value)
        if len(given) != 3 or not 0.0 < sum(one * one for one in given) < float("inf"):
            raise ViewerError(f"up = {given} is no direction: give three numbers, not all 0")
        x, y, z = given
        return (x, y, z)


def main(args: list[str] | None = None) -> int:
    """Serve the page until a signal.

    Args:
        args: the words of the command; None takes those of the process.

    Returns:
        The exit code; 2 for a user's mistake.
    """
    try:
        library("viser", "viewer")
        os.nice(NICE)
        with ros_process(args):
            _serve()
    except ReflestError as error:
        print(f"reflest: error: {error}", file=sys.stderr)
        return 2
    return 0


def _serve() -> None:
    node = ViewerNode()
    executor = MultiThreadedExecutor(2)
    executor.add_node(node)
    spinning = threading.Thread(target=_spin, args=(executor,), daemon=True)
    try:
        source = LiveSource(node, str(node.get_parameter("estimator").value), node.up)
        host, port = node.get_parameter("host").value, node.get_parameter("port").value
        server = ViewerServer(source, str(host), int(port))
        spinning.start()
        serve(server, node.get_logger().info)
    finally:
        executor.shutdown()
        if spinning.is_alive():
            spinning.join()
        node.destroy_node()


def _spin(executor: MultiThreadedExecutor) -> None:
    with contextlib.suppress(ShutdownException):
        executor.spin()


if __name__ == "__main__":
    sys.exit(main())
