# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A node that is configured and cleaned up again and again takes no more memory."""

from __future__ import annotations

import statistics

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState

from test.stress import repeats

CYCLE = (
    Transition.TRANSITION_DEACTIVATE,
    Transition.TRANSITION_CLEANUP,
    Transition.TRANSITION_CONFIGURE,
    Transition.TRANSITION_ACTIVATE,
)
WARM, CYCLES, READINGS = 10, repeats(90, 400), 10
"""Cycles before the first reading, between the first and the last, and readings of one size."""
MOST_GROWTH = 100.0
"""MB over all cycles. Single readings of a flat process lie up to 65 apart, for the allocator keeps
or returns whole heaps; what a cycle of 4.5 MB leaves behind would be 400."""


def cycle(peer, count):
    for _ in range(count):
        for number in CYCLE:
            assert peer.call(ChangeState, "change_state", transition=Transition(id=number)).success


def resident_mb(node, peer):
    """Return the median size after each of some further cycles."""
    sizes = []
    for _ in range(READINGS):
        cycle(peer, 1)
        sizes.append(node.resident_mb)
    return statistics.median(sizes)


def test_memory_is_flat_over_configure_and_cleanup(node, peer):
    cycle(peer, WARM)
    before = resident_mb(node, peer)
    cycle(peer, CYCLES)
    after = resident_mb(node, peer)
    assert after < before + MOST_GROWTH
    assert node.is_running
    assert "Traceback" not in node.output
