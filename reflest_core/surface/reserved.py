# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Arrays that are reserved whole and whose pages the system hands out as they fill.

NumPy leaves that to the C library, which after a few large arrays were given back takes the next
ones from its heap: it then writes all of their zeros at once, and keeps what is given back. A node
whose scan is reset again and again would grow to several times its size.
"""

from __future__ import annotations

import math
import mmap
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

SMALL = 1 << 20
"""Bytes below which an array is an ordinary one."""


def reserved(shape: int | tuple[int, ...], dtype: DTypeLike) -> NDArray[Any]:
    """Reserve an array of zeros that goes back to the system when it is no longer used.

    Args:
        shape: Its shape.
        dtype: Type of its elements.

    Returns:
        The array, C-contiguous and writable.

    Raises:
        MemoryError: The system cannot give as much.
    """
    sizes = (shape,) if isinstance(shape, int) else shape
    size = math.prod(sizes) * np.dtype(dtype).itemsize
    if size < SMALL:
        return np.zeros(sizes, dtype)
    try:
        pages = mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
    except (OSError, OverflowError) as error:
        raise MemoryError(str(error)) from None
    return np.frombuffer(pages, dtype).reshape(sizes)
