# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Minutes of a looping bag, as fast as the node takes them: nothing grows, nothing is lost."""

from __future__ import annotations

import dataclasses

from sphere_messages import messages_of
from sphere_scene import FIRST_STAMP_NS, views

from reflest_ros.srv import Estimate
from test.stress import repeats

MINUTES = repeats(10, 300)
"""Of the bag's time; the long form takes half an hour."""
FRAMES_A_PASS = 24
STEP_NS = 500_000_000
PASSES = round(MINUTES * 60e9 / (FRAMES_A_PASS * STEP_NS))
MAX_WAIT = 60.0
"""A whole pass comes at once, maybe topic by topic: 12 s of image time are then no delay."""
BUDGET_MB = 64.0
CONSTANT_MB = 50.0
"""What a scan may take beside its budget: frames that wait, snapshots, estimation in passing."""


def test_a_looping_bag(start, peer, settings_file):
    node = start(
        "reflest_ros.estimator",
        "--ros-args",
        "--params-file",
        settings_file,
        "-p",
        f"fusion.memory_budget_mb:={BUDGET_MB}",
        "-p",
        "fusion.voxel_size:=0.005",
        "-p",
        f"capture.max_wait:={MAX_WAIT}",
    )
    node.wait_for_line("listening to", 600.0)
    before = node.resident_mb
    one_pass = [
        dataclasses.replace(view, stamp_ns=FIRST_STAMP_NS + number * STEP_NS)
        for number, view in enumerate(views(FRAMES_A_PASS))
    ]
    messages = [list(messages_of(view)) for view in one_pass]
    most = 0.0
    for _ in range(PASSES):
        fused = peer.count("frames fused")
        for view in messages:
            for topic, message in view:
                peer.publish(topic, message)
        # The first message of a pass is taken for a late one until a second confirms the jump.
        peer.wait_for_count("frames fused", fused + FRAMES_A_PASS - 2)
        peer.wait_until(lambda: peer.count("queue") == 0, "the queue does not empty")
        most = max(most, node.resident_mb)

    assert peer.count("frames fused") >= PASSES * (FRAMES_A_PASS - 2)
    assert peer.count("refused clock_jump") == PASSES - 1
    assert most - before < BUDGET_MB + CONSTANT_MB
    peer.wait_for_keyframes()
    assert peer.count("keyframes without an estimate") == 0
    last = peer.call(Estimate, "estimate")
    assert last.success, last.message
    assert last.estimate.view_count == FRAMES_A_PASS
    node.interrupt()
    assert node.exit_code() == 0, node.output
    assert "Traceback" not in node.output
    print(f"resident: {before:.0f} MB at the start, {most:.0f} MB at most")
