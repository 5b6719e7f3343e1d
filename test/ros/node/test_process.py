# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What keeps the node's process from pausing, and what a node that has ended leaves in it."""

from __future__ import annotations

import gc
import sys
import weakref

import pytest
from lifecycle_msgs.msg import Transition
from own_process import participants

from reflest_ros.node import EstimatorNode
from reflest_ros.process import avoid_pauses, give_back_memory, ros_process
from test.waiting import wait_until


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


class Knot:
    """Holds itself, as a scan's objects hold each other."""

    def __init__(self):
        self.own = self


def test_a_scan_that_was_there_when_collections_began_to_leave_it_alone_is_freed_later():
    knot = Knot()
    is_there = weakref.ref(knot)
    interval = sys.getswitchinterval()
    try:
        avoid_pauses()
        del knot
        gc.collect()
        assert is_there() is not None
        give_back_memory()
        assert is_there() is None
        assert gc.get_freeze_count() > 0
    finally:
        gc.unfreeze()
        sys.setswitchinterval(interval)


@pytest.mark.parametrize("is_configured", [False, True], ids=["bare", "configured"])
def test_a_node_that_is_destroyed_is_gone_before_any_garbage_collection(
    domain_id, monkeypatch, is_configured
):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain_id))
    gc.disable()
    try:
        with ros_process(["--ros-args", "-p", "lifecycle.autostart:=false"]):
            node = EstimatorNode()
            if is_configured:
                node.change(Transition.TRANSITION_CONFIGURE)
            assert participants() == 1
            node.destroy_node()
            wait_until(
                lambda: participants() == 0, "others would still see it and call its services"
            )
    finally:
        gc.enable()
