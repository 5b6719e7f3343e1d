# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``ros2 run reflest_ros estimator``: runs the node until SIGINT or SIGTERM."""

from __future__ import annotations

import os
import sys

from rclpy.experimental import EventsExecutor

from reflest_core.errors import ReflestError
from reflest_ros.process import (
    PROFILE_VARIABLE,
    avoid_pauses,
    ignore_signals,
    limit_clean_up,
    limit_heaps,
    ros_process,
)
from reflest_ros.shared_memory import remove_left_segments, room_problem
from reflest_ros.threads import Spinning


def main(args: list[str] | None = None) -> int:
    """Run the node.

    Args:
        args: Command line with ROS arguments; None: that of the process.

    Returns:
        0 after a signal, 2 for a user's mistake, 1 after an internal error.
    """
    limit_heaps()
    try:
        with ros_process(args):
            return _run_node()
    except ReflestError as error:
        print(f"reflest: error: {error}", file=sys.stderr)
        return 2
    return 0


def _run_node() -> int:
    """Return only after a crash; a signal leaves by KeyboardInterrupt."""
    # Imported late, so that a signal during the seconds that it takes ends the process cleanly.
    from reflest_ros.node import EstimatorNode

    removed = remove_left_segments()
    node = EstimatorNode()
    if removed:
        node.get_logger().info(
            f"removed {removed} segments of shared memory of processes that were killed"
        )
    if os.environ.get(PROFILE_VARIABLE) and (problem := room_problem()):
        node.get_logger().warning(problem)
    executor = EventsExecutor()
    executor.add_node(node)
    spinning = Spinning(executor, "executor", node.crash)
    try:
        spinning.start()
        # It answers services and publishes diagnostics meanwhile.
        node.bring_up()
        avoid_pauses()
        node.has_crashed.wait()
    finally:
        # One after the other, so that no callback runs on what is gone.
        ignore_signals()
        limit_clean_up()
        spinning.stop()
        node.destroy_node()
    return 1


if __name__ == "__main__":
    sys.exit(main())
