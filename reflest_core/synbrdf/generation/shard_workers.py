# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Shards made by workers, of this machine or of a cluster, and given back as they are done."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, as_completed
from contextlib import AbstractContextManager
from typing import TypeVar

from reflest_core.errors import ReflestError

Task = TypeVar("Task")


class WorkerError(ReflestError):
    """A worker cannot do its part."""


def finished(
    workers: AbstractContextManager[Executor],
    made: Callable[[Task], bytes],
    tasks: Sequence[Task],
) -> Generator[tuple[Task, bytes]]:
    """Run tasks; when this is closed, those that are not begun are cancelled.

    Args:
        workers: processes or a cluster, as a context.
        made: makes the bytes of a task.
        tasks: shards to make.

    Yields:
        Each task with its bytes.

    Raises:
        WorkerError: A worker was ended from outside.
    """
    if not tasks:
        return
    with workers as executor:
        running: dict[Future[bytes], Task] = {executor.submit(made, task): task for task in tasks}
        try:
            for future in as_completed(list(running)):
                yield running.pop(future), future.result()
        except (BrokenExecutor, CancelledError) as error:
            raise WorkerError(
                "a worker was ended from outside, perhaps for want of memory: the same command "
                "goes on, with fewer --jobs if need be"
            ) from error
        finally:
            for future in running:
                future.cancel()
