# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Threads of the node: none ends without a report, none outlives the node."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import TypeVar

from rclpy.executors import Executor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from reflest_core.errors import ReflestError

InvalidHandle: type[Exception] = _rclpy.InvalidHandle

LONGEST_WAIT = 0.5
"""Seconds; the executor is woken at the end, this only bounds what a missed call would cost."""

T = TypeVar("T")


def worker_thread(
    name: str, run: Callable[[], None], on_crash: Callable[[BaseException], None]
) -> threading.Thread:
    """Make a daemon thread whose unexpected end is reported.

    Args:
        name: Name of the thread in a debugger.
        run: What the thread does.
        on_crash: Called in the thread with what ``run`` raised.

    Returns:
        The thread, not started.
    """

    def guarded() -> None:
        try:
            run()
        except BaseException as error:
            on_crash(error)

    return threading.Thread(target=guarded, name=name, daemon=True)


def resolve(futures: Sequence[Future[T]], work: Callable[[], T]) -> None:
    """Run ``work`` once and give the futures its result or what it raised.

    Args:
        futures: Futures that nobody has resolved yet.
        work: Any exception of it becomes the futures'.
    """
    try:
        result = work()
    except BaseException as error:  # raised again where a future's result is asked for
        for future in futures:
            future.set_exception(error)
    else:
        for future in futures:
            future.set_result(result)


def shutting_down() -> ReflestError:
    """Return what the futures of a worker that has been stopped end with."""
    return ReflestError("the estimator is shutting down")


def _nothing() -> None:
    """A task whose only purpose is to be one."""


class Spinning:
    """Runs the callbacks of an executor's nodes in a thread of its own."""

    def __init__(
        self, executor: Executor, name: str, on_crash: Callable[[BaseException], None]
    ) -> None:
        """Prepare the thread.

        Args:
            executor: Any of rclpy's executors; it is shut down by :meth:`stop`.
            name: Name of the thread.
            on_crash: Called with what a callback raised; the thread then ends.
        """
        self._executor = executor
        self._is_ending = threading.Event()
        self._thread = worker_thread(name, self._spin, on_crash)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def wake(self) -> None:
        """Make the executor look at what its nodes hold now."""
        self._executor.wake()

    def stop(self) -> None:
        """End the thread after the current callback, then shut the executor down."""
        self._is_ending.set()
        if self._thread.ident is not None:
            # Of a wait with nothing to do rclpy's executors return to run a task, not when woken.
            self._executor.create_task(_nothing)
            self._thread.join()
        self._executor.shutdown()

    def _spin(self) -> None:
        while not self._is_ending.is_set():
            # An event may still be queued of what another thread has destroyed meanwhile.
            with contextlib.suppress(InvalidHandle):
                self._executor.spin_once(timeout_sec=LONGEST_WAIT)
