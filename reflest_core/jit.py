# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How inner loops are compiled.

The kernels run without the global interpreter lock, so that the estimator's thread goes on beside
them. Each has one order of evaluation, so that every result is bit-identical from run to run;
fusion shares its large ones out in pieces that do not depend on each other
(``fusion.work_sharing``). The compiled code is cached on disk; Numba notices an edit only in the
file of the kernel itself, so delete ``__pycache__`` after editing a function that other files'
kernels call.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numpy.typing import DTypeLike, NDArray

F = TypeVar("F", bound=Callable[..., object])


def compiled(function: F) -> F:
    """Return ``function`` compiled to machine code at its first call."""
    return cast(F, numba.njit(cache=True, nogil=True, error_model="numpy")(function))


def vectorised(function: F) -> F:
    """The same, where plain loops over arrays of finite numbers are to use vector instructions.

    No value depends on the flags but those of NaNs and the sign of zeros.
    """
    decorator = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath={"nnan", "nsz"})
    return cast(F, decorator(function))


def kernel_array(array: NDArray[Any], dtype: DTypeLike) -> NDArray[Any]:
    """``array`` itself or a copy: of ``dtype``, C-contiguous and writable.

    A kernel is compiled anew, for seconds, for every other layout; images that wrap a message's
    buffer, for one, are read-only.
    """
    return np.require(array, dtype, ["C", "W"])
