# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is missing between a publisher's numbers, and how callbacks learn the numbers."""

from __future__ import annotations

import pytest
import rclpy
from hypothesis import given
from hypothesis import strategies as st
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.experimental import EventsExecutor
from std_msgs.msg import String

from reflest_ros.inputs.publication_gaps import PublicationGaps, with_message_info


@given(st.integers(1, 2**40), st.sets(st.integers(1, 200)))
def test_every_number_between_two_that_came_is_lost(first, kept):
    gaps = PublicationGaps()
    came = [first, *(first + one for one in sorted(kept))]
    lost = sum(gaps.lost_before(number, float(time), 1) for time, number in enumerate(came))
    assert lost == came[-1] - first + 1 - len(came)


def lost(numbers, publishers=1, seconds=1.0):
    """Losses before each number, the messages that many seconds apart."""
    gaps = PublicationGaps()
    return [gaps.lost_before(n, seconds * i, publishers) for i, n in enumerate(numbers)]


def test_a_publisher_that_restarts_lost_nothing():
    assert lost((7, 8, 1, 2, 4)) == [0, 0, 0, 0, 1]


def test_a_middleware_without_numbers_shows_no_loss():
    assert lost((None, 5, None, 9)) == [0, 0, 0, 0]


def test_numbers_of_several_publishers_are_not_compared():
    assert lost((5, 200_000, 6, 200_001), publishers=2) == [0, 0, 0, 0]


def test_a_gap_that_no_publisher_can_make_in_the_time_is_another_publishers():
    assert lost((5, 200_005), seconds=1.0) == [0, 0]
    assert lost((5, 9), seconds=0.01) == [0, 3]


def test_numbers_are_not_compared_across_a_change_of_publishers():
    gaps = PublicationGaps()
    assert gaps.lost_before(5, 0.0, 1) == 0
    gaps.begin()
    assert gaps.lost_before(50, 1.0, 1) == 0
    assert gaps.lost_before(52, 2.0, 1) == 1


@pytest.mark.parametrize("make", [SingleThreadedExecutor, EventsExecutor])
def test_each_executor_passes_the_numbers_on(make, domain_id):
    context = Context()
    rclpy.init(context=context, domain_id=domain_id)
    node = rclpy.create_node("listener", context=context)
    came = []

    @with_message_info
    def on_message(message, info):
        came.append((message.data, info["publication_sequence_number"]))

    node.create_subscription(String, "words", on_message, 10)
    output = node.create_publisher(String, "words", 10)
    executor = make(context=context)
    executor.add_node(node)
    for word in ("one", "two", "three"):
        output.publish(String(data=word))
    while len(came) < 3:
        executor.spin_once(timeout_sec=10.0)
    executor.shutdown()
    node.destroy_node()
    context.try_shutdown()
    assert came == [("one", 1), ("two", 2), ("three", 3)]
