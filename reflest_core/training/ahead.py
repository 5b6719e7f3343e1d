# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Minibatches made ahead of the optimiser."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

import torch

AHEAD = 4

T = TypeVar("T")


def made_ahead(make: Callable[[int], T], numbers: range, device: torch.device) -> Iterator[T]:
    """``make`` of each number, in order.

    On a CPU a second thread prepares them; a GPU's queue of kernels is ahead by itself.
    """
    if device.type != "cpu":
        yield from map(make, numbers)
        return
    with ThreadPoolExecutor(1) as pool:
        waiting: list[Future[T]] = []
        upcoming = iter(numbers)
        for _ in numbers:
            while len(waiting) < AHEAD and (number := next(upcoming, None)) is not None:
                waiting.append(pool.submit(make, number))
            yield waiting.pop(0).result()
