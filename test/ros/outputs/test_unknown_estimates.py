# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is not known never looks like an estimate that can be trusted."""

from __future__ import annotations

import math

from std_srvs.srv import Trigger

from reflest_ros.msg import BrdfEstimate
from reflest_ros.srv import Estimate, LoadScan, SaveScan, SetRegion


def latched(peer):
    """What a subscriber that comes now finds on the topic."""
    found = peer.listen(BrdfEstimate, "/reflectance/brdf")
    peer.wait_until(lambda: found, "nothing is latched")
    return found[0]


def is_unknown(message):
    numbers = [*message.rho_d, message.rho_s, message.alpha]
    return message.status == BrdfEstimate.STATUS_UNKNOWN and all(map(math.isnan, numbers))


def scan_something(feed, peer):
    for _ in range(8):
        feed.send_good()
    answer = peer.call(Estimate, "estimate")
    assert answer.success, answer.message
    assert answer.duration > 0.0
    return answer.estimate


def test_a_reset_and_another_region_leave_no_estimate_behind(feed, peer):
    scan_something(feed, peer)
    assert latched(peer).status != BrdfEstimate.STATUS_UNKNOWN
    assert peer.call(Trigger, "reset").success
    assert is_unknown(latched(peer))
    answer = peer.call(Estimate, "estimate")
    assert not answer.success
    assert is_unknown(answer.estimate)

    scan_something(feed, peer)
    assert peer.call(SetRegion, "set_region", shape=SetRegion.Request.SHAPE_NONE).success
    assert is_unknown(latched(peer))


def test_a_loaded_scan_is_estimated_before_its_next_keyframe(feed, peer, tmp_path):
    path = str(tmp_path / "scan")
    scan_something(feed, peer)
    saved = peer.call(SaveScan, "save", path=path)
    assert saved.success
    assert saved.duration > 0.0
    whole = peer.call(Estimate, "estimate").estimate
    assert peer.call(Trigger, "reset").success
    assert is_unknown(latched(peer))
    before = len(peer.estimates)
    assert peer.call(LoadScan, "load", path=path).success
    peer.wait_until(lambda: len(peer.estimates) > before, "the loaded scan is not estimated")
    assert list(peer.estimates[-1].rho_d) == list(whole.rho_d)
