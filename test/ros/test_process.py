# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What keeps the node's process from pausing."""

from __future__ import annotations

import gc
import sys

from reflest_ros.process import avoid_pauses


def test_collections_leave_alone_what_was_loaded():
    interval = sys.getswitchinterval()
    loaded = [[] for _ in range(1000)]
    try:
        avoid_pauses()
        assert gc.get_freeze_count() >= len(loaded)
        assert not any(one is loaded for one in gc.get_objects())
        assert sys.getswitchinterval() < interval
    finally:
        gc.unfreeze()
        sys.setswitchinterval(interval)
