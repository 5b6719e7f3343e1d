# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How often tests try random things: a short form, and a long one for ``make stress``."""

from __future__ import annotations

import os


def repeats(short: int, long: int) -> int:
    """``long`` where REFLEST_STRESS is set, else ``short``."""
    return long if os.environ.get("REFLEST_STRESS") else short
