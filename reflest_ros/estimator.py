"""``ros2 run reflest_ros estimator``: runs the node until SIGINT or SIGTERM."""

from __future__ import annotations

import signal
import sys

import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor

from reflest_core.errors import ReflestError

EXECUTOR_THREADS = 3
"""One for the subscriptions, two for services that wait for fusion."""


def main(args: list[str] | None = None) -> int:
    """Run the node; 0 after a signal, 2 for a user's mistake, 1 for ours."""
    rclpy.init(args=args)
    node = None
    try:
        # Imported late, so that a signal during the seconds that it takes ends the process cleanly.
        from reflest_ros.node import EstimatorNode

        node = EstimatorNode()
        executor = MultiThreadedExecutor(EXECUTOR_THREADS)
        executor.add_node(node)
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except ReflestError as error:
        print(f"reflest: error: {error}", file=sys.stderr)
        return 2
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()
    return 1 if node is not None and node.has_crashed else 0


if __name__ == "__main__":
    sys.exit(main())
