# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An executor that spins in a thread of its own until it is stopped."""

from __future__ import annotations

import threading
from collections.abc import Callable

from rclpy.executors import Executor

from reflest_ros.workers.worker_thread import worker_thread

LONGEST_WAIT = 0.5
"""Seconds; the executor is woken at the end, this only bounds what a missed call would cost."""


class Spinning:
    """Runs the callbacks of an executor's nodes; what they raise is handed to ``on_crash``."""

    def __init__(
        self, executor: Executor, name: str, on_crash: Callable[[BaseException], None]
    ) -> None:
        self._executor = executor
        self._is_ending = threading.Event()
        self._thread = worker_thread(name, self._spin, on_crash)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """End the thread after the callback in hand, then the executor."""
        self._is_ending.set()
        self._executor.wake()
        if self._thread.ident is not None:
            self._thread.join()
        self._executor.shutdown()

    def _spin(self) -> None:
        while not self._is_ending.is_set():
            self._executor.spin_once(timeout_sec=LONGEST_WAIT)
