# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Shared memory of Fast DDS: what killed processes left, and whether there is room."""

from __future__ import annotations

import contextlib
import fcntl
import os
import time
from pathlib import Path

FOLDER = Path("/dev/shm")
LOCK_SUFFIX = "_el"
"""Fast DDS holds a lock on a segment's file of this suffix for as long as the segment is in use."""
SEGMENT_MB = 36.0
"""Of a participant with config/fastdds_large_messages.xml."""
YOUNGEST_S = 60.0
"""Seconds that a segment must be old: one that is just being made is not locked yet."""
PARTICIPANTS = 2
"""That must have room: this node and a publisher."""


def remove_left_segments(folder: Path = FOLDER) -> int:
    """Remove segments of the user's own processes that have ended without removing them.

    A process that is killed (SIGKILL) leaves its segment. One of some age whose lock can be had
    belongs to nobody any more; all others stay.

    Args:
        folder: Where the system keeps shared memory.

    Returns:
        The number of segments that were removed.
    """
    removed = 0
    for lock in folder.glob(f"fastrtps_*{LOCK_SUFFIX}"):
        segment = lock.with_name(lock.name.removesuffix(LOCK_SUFFIX))
        if segment.name.startswith("fastrtps_port") or not segment.exists():
            continue
        with contextlib.suppress(OSError):
            state = lock.stat()
            if segment.stat().st_uid != os.getuid() or state.st_uid != os.getuid():
                continue
            if time.time() - state.st_mtime < YOUNGEST_S:
                continue
            descriptor = os.open(lock, os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                segment.unlink()
                lock.unlink()
                removed += 1
            finally:
                os.close(descriptor)
    return removed


def room_problem(folder: Path = FOLDER) -> str:
    """Look whether the shipped profile of Fast DDS has the shared memory that it asks for.

    Args:
        folder: Where the system keeps shared memory.

    Returns:
        One sentence that says what to change, or "".
    """
    try:
        state = os.statvfs(folder)
    except OSError:
        return ""
    total_mb = state.f_frsize * state.f_blocks / 1e6
    needed_mb = PARTICIPANTS * SEGMENT_MB
    if total_mb >= needed_mb:
        return ""
    return (
        f"{folder} has {total_mb:.0f} MB, and two processes with the shipped profile of Fast DDS "
        f"need {needed_mb:.0f} MB: start the container with --shm-size=256m (or --ipc=host), or "
        "unset FASTRTPS_DEFAULT_PROFILES_FILE; large images may be lost"
    )
