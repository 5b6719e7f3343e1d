# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Starting and ending a ROS process so that a signal at any time ends it cleanly.

Also what keeps it from pausing in between.
"""

from __future__ import annotations

import contextlib
import gc
import signal
import sys
from collections.abc import Iterator

import rclpy
from rclpy.signals import SignalHandlerOptions

SIGNALS = (signal.SIGINT, signal.SIGTERM)

HAND_OVER = 0.001
"""Seconds after which a thread must let another one go on in Python; 5 ms unless set."""


@contextlib.contextmanager
def ros_process(args: list[str] | None) -> Iterator[None]:
    """Hold a ROS context for the block; SIGINT and SIGTERM end the block early.

    rclpy's own handlers would invalidate the context at once, under the threads that still
    publish. Here a signal raises KeyboardInterrupt in the main thread, which leaves the block in
    order; later signals are ignored, so that nothing interrupts the clean-up.
    """
    for number in SIGNALS:
        signal.signal(number, signal.default_int_handler)
    try:
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        yield
    except KeyboardInterrupt:
        pass
    finally:
        ignore_signals()
        rclpy.try_shutdown()


def ignore_signals() -> None:
    """Let the clean-up run to its end."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def avoid_pauses() -> None:
    """Once started: threads hand over soon, and what was loaded is not searched for garbage again.

    A collection of all that the libraries leave behind stops every thread for 40 to 70 ms.
    """
    sys.setswitchinterval(HAND_OVER)
    gc.collect()
    gc.freeze()
