# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Kernels shared out between threads, with results that do not depend on how many there are.

A shared kernel is called as ``kernel(start, stop, ...)`` and treats the items from ``start`` to
``stop``, independently of all others; what it returns is put together in the order of the items.
The threads are Python's and the kernels release the global interpreter lock: Numba's own threads
would end the process where the estimator's thread ran such a kernel at the same time, or spin
between kernels on a processor that the estimator needs.
"""

from __future__ import annotations

import functools
import itertools
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

T = TypeVar("T")


def share_out(
    threads: int, count: int, least: int, kernel: Callable[..., T], *arguments: Any
) -> list[T]:
    """Run a kernel over items in parts that threads share.

    The calling thread takes a part, and then those that no other thread has begun: where all
    processors are busy, waiting for one takes longer than the work.

    Args:
        threads: Parts at most.
        count: Items.
        least: Items of a part at least.
        kernel: Called as ``kernel(start, stop, *arguments)``.
        *arguments: Its further arguments.

    Returns:
        What the parts returned, in order; always at least one.
    """
    parts = max(1, min(threads, count // least))
    if parts == 1:
        return [kernel(0, count, *arguments)]
    bounds = [count * part // parts for part in range(parts + 1)]
    others = [
        (_pool(parts - 1).submit(kernel, start, stop, *arguments), start, stop)
        for start, stop in itertools.pairwise(bounds[1:])
    ]
    results = [kernel(0, bounds[1], *arguments)]
    for other, start, stop in others:
        results.append(kernel(start, stop, *arguments) if other.cancel() else other.result())
    return results


@functools.cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="fusion-kernel")


# A forked child has none of its parent's threads.
os.register_at_fork(after_in_child=_pool.cache_clear)
