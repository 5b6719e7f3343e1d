# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Lateness, one wrong stamp and a clock that jumps back are distinguished, on any set of topics."""

from hypothesis import given, settings
from hypothesis import strategies as st

from reflest_core.capture.messages import Role
from reflest_core.capture.sync.stamp_clock import StampClock, StampVerdict

S = 10**9
TOPICS = (Role.RGB, Role.DEPTH, Role.POSE)


def fed(clock, second, roles=TOPICS):
    return [clock.take(role, round(second * S)) for role in roles]


def test_a_small_step_back_is_late_and_changes_nothing():
    clock = StampClock(jump=1.0)
    fed(clock, 10)
    assert clock.take(Role.RGB, 10 * S) is StampVerdict.LATE
    assert clock.take(Role.RGB, round(9.01 * S)) is StampVerdict.LATE
    assert clock.latest(Role.RGB) == 10 * S


def test_a_jump_is_reported_once_and_all_topics_follow():
    clock = StampClock(jump=1.0)
    fed(clock, 100)
    assert clock.take(Role.DEPTH, 5 * S) is StampVerdict.LATE, "it may be a mistake"
    assert clock.take(Role.RGB, 5 * S) is StampVerdict.CLOCK_JUMPED
    assert clock.take(Role.POSE, 5 * S) is StampVerdict.NEXT
    assert fed(clock, 6) == [StampVerdict.NEXT] * 3


def test_what_is_still_under_way_at_a_jump_is_dropped():
    clock = StampClock(jump=1.0)
    fed(clock, 100)
    clock.take(Role.RGB, 5 * S)
    assert clock.take(Role.RGB, round(5.03 * S)) is StampVerdict.CLOCK_JUMPED
    assert clock.take(Role.POSE, round(100.03 * S)) is StampVerdict.BEFORE_JUMP
    assert clock.take(Role.POSE, 5 * S) is StampVerdict.NEXT
    assert clock.take(Role.RGB, 6 * S) is StampVerdict.NEXT


def test_one_topic_that_was_ahead_is_not_the_clock():
    clock = StampClock(jump=1.0)
    fed(clock, 10)
    clock.take(Role.RGB, 2**31 * S)
    assert clock.take(Role.RGB, 11 * S) is StampVerdict.TOPIC_WAS_AHEAD
    assert fed(clock, 12) == [StampVerdict.NEXT] * 3


def test_one_stamp_far_back_is_not_the_clock():
    clock = StampClock(jump=1.0)
    for second in (100, 200, 300):
        fed(clock, second)
        assert clock.take(Role.RGB, 0) is StampVerdict.LATE
        assert fed(clock, second + 1) == [StampVerdict.NEXT] * 3
    clock.take(Role.RGB, 0)
    assert clock.take(Role.RGB, 0) is StampVerdict.LATE, "a stamp that nobody fills in"


def test_after_a_reset_any_stamp_may_come():
    clock = StampClock(jump=1.0)
    fed(clock, 10)
    clock.reset()
    assert fed(clock, 1) == [StampVerdict.NEXT] * 3


@settings(max_examples=300)
@given(
    st.lists(st.tuples(st.sampled_from(TOPICS), st.integers(0, 2**62)), max_size=30),
    st.integers(0, 2**40),
)
def test_whatever_came_the_clock_finds_its_way_back(garbage, start_ns):
    """Three good rounds later, every topic is taken again."""
    clock = StampClock(jump=1.0)
    for role, stamp_ns in garbage:
        clock.take(role, stamp_ns)
    for step in range(1, 100):
        verdicts = fed(clock, (start_ns + step * S // 30) / S)
    assert verdicts == [StampVerdict.NEXT] * 3


@settings(max_examples=300)
@given(
    st.lists(st.sampled_from(TOPICS), min_size=1, max_size=60),
    st.integers(2, 1000),
    st.randoms(use_true_random=False),
)
def test_a_bag_that_loops_jumps_once_whatever_the_order(order, length, random):
    """Each topic loops at its own moment; messages of both passes mix."""
    clock = StampClock(jump=1.0)
    for step in range(30):
        fed(clock, length - 1 + step / 30)
    second_pass = {role: iter(range(1000)) for role in TOPICS}
    late = {role: random.randint(0, 2) for role in TOPICS}
    jumps = 0
    for role in order:
        if late[role] > 0:
            late[role] -= 1
            stamp = length + (3 - late[role]) / 30
        else:
            stamp = next(second_pass[role]) / 30
        jumps += clock.take(role, round(stamp * S)) is StampVerdict.CLOCK_JUMPED
    assert jumps <= 1
