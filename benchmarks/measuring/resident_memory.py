# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Resident memory of a process as Linux counts it."""

from __future__ import annotations

import re
from pathlib import Path

MB = 1e6


def resident_mb(process: int | str = "self") -> float:
    """Present resident memory, 10^6 bytes.

    Args:
        process: Its id, or ``self``.
    """
    return _status("VmRSS", process)


def peak_mb(process: int | str = "self") -> float:
    """Maximum of the resident memory since the start or the last :func:`forget_peak`, 10^6 bytes.

    Args:
        process: Its id, or ``self``.
    """
    return _status("VmHWM", process)


def forget_peak() -> bool:
    """Reset this process's peak; False where the kernel does not allow that."""
    try:
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return False
    return True


def _status(name: str, process: int | str) -> float:
    text = Path(f"/proc/{process}/status").read_text()
    match = re.search(rf"^{name}:\s+(\d+) kB$", text, re.MULTILINE)
    if match is None:
        raise ProcessLookupError(f"process {process} has ended")
    return int(match.group(1)) * 1024 / MB
