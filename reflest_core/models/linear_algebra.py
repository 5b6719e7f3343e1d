# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Matrix products in NumPy: dense layers, and how many threads they take."""

from __future__ import annotations

import importlib
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import LibController, ThreadpoolController

from reflest_core.models.weights import Tensors

Array = NDArray[np.float32]

_lock = threading.Lock()
_threads_before: list[tuple[LibController, int]] = []
_holders = 0


def product(left: Array, right: Array, out: Array | None = None) -> Array:
    """Multiply matrices.

    Args:
        left: (..., N).
        right: (N, M).
        out: (..., M), where the result goes; None makes an array.
    """
    return np.asarray(np.matmul(left, right, out=out))


class DenseLayer(NamedTuple):
    """A fully connected layer.

    Attributes:
        weight: (inputs, outputs) float32.
        bias: (outputs,) float32.
    """

    weight: Array
    bias: Array

    @staticmethod
    def of(tensors: Tensors, name: str) -> DenseLayer:
        """Take the layer ``<name>.weight`` (outputs, inputs) and ``<name>.bias`` as stored.

        Args:
            tensors: The trained weights by name.
            name: Of the layer.
        """
        return DenseLayer(
            np.ascontiguousarray(tensors[f"{name}.weight"].T), tensors[f"{name}.bias"]
        )

    def linear(self, values: Array, space: Array | None = None) -> Array:
        """Apply the layer.

        Args:
            values: (..., inputs).
            space: Array whose first rows take the result, where memory is to be reused.

        Returns:
            (..., outputs).
        """
        out = None if space is None else space[: len(values)]
        products = product(values, self.weight, out)
        products += self.bias
        return products

    def tanh(self, values: Array, space: Array | None = None) -> Array:
        """Apply the layer, then tanh.

        Args:
            values: (..., inputs).
            space: Array whose first rows take the result, where memory is to be reused.
        """
        products = self.linear(values, space)
        return np.tanh(products, out=products)


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Run NumPy's products in the thread that asks for them, in one order of summing.

    The limit holds for the whole process, since BLAS libraries have no other, until the last of
    those who are within it at once has left.
    """
    global _holders
    with _lock:
        if _holders == 0:
            for library in _blas_libraries():
                _threads_before.append((library, library.num_threads))
                library.set_num_threads(1)
        _holders += 1
    try:
        yield
    finally:
        with _lock:
            _holders -= 1
            if _holders == 0:
                for library, threads in _threads_before:
                    library.set_num_threads(threads)
                _threads_before.clear()


def run_in_threads(work: Callable[[int], None], threads: int) -> None:
    """Call ``work(0)`` to ``work(threads - 1)``, each in a thread of its own if there are more.

    Args:
        work: Called with the number of each thread.
        threads: How many.
    """
    if threads == 1:
        work(0)
        return
    with ThreadPoolExecutor(threads) as pool:
        for done in [pool.submit(work, worker) for worker in range(threads)]:
            done.result()


@cache
def _blas_libraries() -> tuple[LibController, ...]:
    """Those that are loaded; set one by one, which takes a fifth of what a limit of all takes."""
    importlib.import_module("scipy.linalg")  # brings its own
    return tuple(ThreadpoolController().select(user_api="blas").lib_controllers)


# At import: a thread that searches while another one loads a library (``import viser``) holds the
# loader's lock and waits for the interpreter's, and the other one the other way round.
_blas_libraries()
