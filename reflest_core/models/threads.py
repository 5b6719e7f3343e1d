# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How many threads an estimate takes: those that it is given, and not one for every core."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController


@cache
def _libraries() -> ThreadpoolController:
    return ThreadpoolController()


_lock = threading.Lock()
_limit = ExitStack()
_holders = 0


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Within it NumPy's products run in the thread that asks for them, in one order of summing.

    It holds for the whole process, as the BLAS libraries know no other way, until the last of those
    who are within it at once has left.
    """
    global _holders
    with _lock:
        if _holders == 0:
            _limit.enter_context(_libraries().limit(limits=1, user_api="blas"))
        _holders += 1
    try:
        yield
    finally:
        with _lock:
            _holders -= 1
            if _holders == 0:
                _limit.close()


def run_in_threads(work: Callable[[int], None], threads: int) -> None:
    """Call ``work(0)`` to ``work(threads - 1)``, each in a thread of its own if there are more."""
    if threads == 1:
        work(0)
        return
    with ThreadPoolExecutor(threads) as pool:
        for done in [pool.submit(work, worker) for worker in range(threads)]:
            done.result()
