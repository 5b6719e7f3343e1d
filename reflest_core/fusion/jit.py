"""How fusion's inner loops are compiled.

The kernels run without the global interpreter lock, so that the estimator's thread goes on beside
them, and on one thread, so that every result has one order of evaluation and is bit-identical from
run to run. The compiled code is cached on disk; Numba notices an edit only in the file of the
kernel itself, so delete ``__pycache__`` after editing a function that other files' kernels call.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """Return ``function`` compiled to machine code at its first call."""
    return cast(F, numba.njit(cache=True, nogil=True, error_model="numpy")(function))
