# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Freed memory is kept for the next minibatch: asking the kernel for it anew costs a third."""

from __future__ import annotations

import ctypes

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD, M_ARENA_MAX = -1, -3, -8
"""From glibc's ``malloc.h``."""
LARGEST = 1 << 30
"""Bytes, of a block and of what is kept free."""


def keep_freed_memory() -> None:
    """Tell glibc's allocator; where there is another one, do nothing."""
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_ARENA_MAX, 1)  # what the drawing thread frees, the training thread takes
        mallopt(M_MMAP_THRESHOLD, LARGEST)
        mallopt(M_TRIM_THRESHOLD, LARGEST)
