# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A node that is configured and cleaned up again and again takes no more memory."""

from __future__ import annotations

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState

from test.stress import repeats

CYCLE = (
    Transition.TRANSITION_DEACTIVATE,
    Transition.TRANSITION_CLEANUP,
    Transition.TRANSITION_CONFIGURE,
    Transition.TRANSITION_ACTIVATE,
)
WARM, CYCLES = 10, repeats(30, 120)
"""The allocator keeps what the first cycles freed in pieces; then the size is level."""
MOST_GROWTH = 50.0
"""MB, for it comes and goes by 30; without care the first cycles add 5 each, and more once more
than two threads have made heaps."""


def cycle(peer, count):
    for _ in range(count):
        for number in CYCLE:
            assert peer.call(ChangeState, "change_state", transition=Transition(id=number)).success


def test_memory_is_flat_over_configure_and_cleanup(node, peer):
    cycle(peer, WARM)
    before = node.resident_mb
    cycle(peer, CYCLES)
    after = node.resident_mb
    assert after < before + MOST_GROWTH
    assert node.is_running
    assert "Traceback" not in node.output
