# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Waiting for what other threads and processes do, on a machine of any speed."""

from __future__ import annotations

import time
from collections.abc import Callable

PATIENCE = 300.0
"""Seconds after which something is broken: no test waits so long for what works."""


def wait_until(
    is_true: Callable[[], bool], what: str, patience: float = PATIENCE, step: float = 0.01
) -> None:
    """Return as soon as ``is_true``, asked every ``step`` seconds; fail with ``what`` otherwise."""
    end = time.monotonic() + patience
    while not is_true():
        assert time.monotonic() < end, what
        time.sleep(step)
