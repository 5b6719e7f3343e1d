# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``ros2 run reflest_ros estimator``: runs the node until SIGINT or SIGTERM."""

from __future__ import annotations

import sys
import threading

from rclpy.executors import MultiThreadedExecutor

from reflest_core.errors import ReflestError
from reflest_ros.process import ignore_signals, ros_process
from reflest_ros.worker_thread import worker_thread

EXECUTOR_THREADS = 4
"""One for the subscriptions, one for the diagnostics, two for services that wait for fusion."""

LONGEST_WAIT = 0.5
"""Seconds; the executor is woken at the end, this only bounds what a missed call would cost."""


def main(args: list[str] | None = None) -> int:
    """Run the node; 0 after a signal, 2 for a user's mistake, 1 for ours."""
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

    node = EstimatorNode()
    node.bring_up()
    executor = MultiThreadedExecutor(EXECUTOR_THREADS)
    executor.add_node(node)
    is_ending = threading.Event()

    def spin() -> None:
        while not is_ending.is_set():
            executor.spin_once(timeout_sec=LONGEST_WAIT)

    spinning = worker_thread("executor", spin, node.crash)
    try:
        spinning.start()
        node.has_crashed.wait()
    finally:
        # One after the other, so that no callback runs on what is gone.
        ignore_signals()
        is_ending.set()
        executor.wake()
        spinning.join()
        executor.shutdown()
        node.destroy_node()
    return 1


if __name__ == "__main__":
    sys.exit(main())
