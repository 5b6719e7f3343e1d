# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Time that goes back: a bag that loops, and a simulated clock that is set back."""

from __future__ import annotations

import pytest
from builtin_interfaces.msg import Time
from rosgraph_msgs.msg import Clock
from sphere_messages import messages_of
from sphere_scene import views

PASS = list(views(8))


def send(peer, some):
    for view in some:
        for topic, message in messages_of(view):
            peer.publish(topic, message)


def set_clock(peer, seconds):
    """Publish the time again, as clocks do; whether it has arrived."""
    peer.publish("/clock", Clock(clock=Time(sec=seconds)))
    return peer.node_time == seconds


@pytest.fixture(scope="module", params=[False, True], ids=["keeping", "resetting"])
def resets(request):
    return request.param


@pytest.fixture(scope="module")
def jumping(start, settings_file, resets):
    node = start(
        "reflest_ros.estimator",
        "--ros-args",
        "--params-file",
        settings_file,
        "-p",
        "use_sim_time:=true",
        "-p",
        "capture.clock_jump:=0.05",
        "-p",
        f"input.reset_on_clock_jump:={str(resets).lower()}",
    )
    node.wait_for_line("listening to", 600.0)
    yield node
    node.interrupt()
    assert node.exit_code() == 0, node.output
    assert "Traceback" not in node.output


def test_a_bag_that_loops_is_fused_again(jumping, peer, resets):
    peer.diagnostics = {}
    send(peer, PASS)
    peer.wait_for_count("frames fused", len(PASS))
    views_of_one_pass = peer.count("views")
    assert views_of_one_pass == len(PASS)

    send(peer, PASS[:4])
    peer.wait_for_count("refused clock_jump", 1)
    jumping.wait_for_line(r"\(cause: clock_jump; logged once\)")
    peer.wait_for_count("frames fused", len(PASS) + 2)
    if resets:
        peer.wait_until(lambda: 0 < peer.count("views") < len(PASS), "the old views are left")
    else:
        assert peer.count("views") == views_of_one_pass
    # The next pass is not refused for ever.
    fused = peer.count("frames fused")
    send(peer, PASS[4:])
    peer.wait_for_count("frames fused", fused + 4)


def test_a_clock_that_is_set_back_drops_what_waits(jumping, peer, resets):
    jumps = peer.count("refused clock_jump")
    for seconds in (200, 100):
        peer.wait_until(lambda now=seconds: set_clock(peer, now), "the clock was not set")
    peer.wait_for_count("refused clock_jump", jumps + 1)
    if resets:
        peer.wait_until(lambda: peer.diagnostics["views"] == "0", "the old views are left")
    fused = peer.count("frames fused")
    send(peer, PASS[:3])
    peer.wait_for_count("frames fused", fused + 3)


def test_diagnostics_go_on_while_simulated_time_stands_still(jumping, peer):
    before = peer.diagnostics
    peer.wait_until(lambda: peer.diagnostics is not before, "nothing comes")
