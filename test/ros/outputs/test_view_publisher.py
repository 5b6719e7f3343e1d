# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Messages are made for those who look, and for nobody else."""

from __future__ import annotations

import pytest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String

from reflest_ros.inputs.qos import OUTPUT_QOS
from reflest_ros.outputs.view_publisher import ViewPublisher


class Made:
    """A message that counts how often it was made."""

    def __init__(self, text):
        self.text = text
        self.count = 0

    def __call__(self):
        self.count += 1
        return String(data=self.text)


@pytest.fixture
def node(domain_id):
    context = Context()
    rclpy.init(context=context, domain_id=domain_id)
    node = rclpy.create_node("shows", context=context)
    yield node
    node.destroy_node()
    context.try_shutdown()


@pytest.fixture
def spin_until(node):
    executor = SingleThreadedExecutor(context=node.context)
    executor.add_node(node)

    def spin(is_true):
        for _ in range(1200):
            if is_true():
                return
            executor.spin_once(timeout_sec=0.1)
        raise AssertionError("it did not come")

    yield spin
    executor.shutdown()


@pytest.fixture
def publisher(node):
    publisher = ViewPublisher(node, String, "look")
    yield publisher
    publisher.destroy()


def listen(node):
    texts = []
    subscription = node.create_subscription(
        String, "look", lambda message: texts.append(message.data), OUTPUT_QOS
    )
    return texts, subscription


def test_nothing_is_made_while_nobody_looks(publisher):
    first, second = Made("first"), Made("second")
    publisher.show(first)
    publisher.show(second)
    assert (first.count, second.count) == (0, 0)


def test_a_newcomer_gets_the_last_one_made_for_it(node, publisher, spin_until):
    first, second = Made("first"), Made("second")
    publisher.show(first)
    publisher.show(second)
    texts, _ = listen(node)
    spin_until(lambda: texts == ["second"])
    assert (first.count, second.count) == (0, 1)

    third = Made("third")
    publisher.show(third)
    spin_until(lambda: texts == ["second", "third"])
    # The next one to come is served by DDS.
    others, _ = listen(node)
    spin_until(lambda: others == ["third"])
    assert third.count == 1


def test_what_replaces_is_published_to_all(node, publisher, spin_until):
    first = Made("first")
    publisher.show(first)
    publisher.replace(String(data="empty"))
    texts, _ = listen(node)
    spin_until(lambda: texts == ["empty"])
    assert first.count == 0


def test_who_leaves_is_not_served(node, publisher, spin_until):
    texts, subscription = listen(node)
    publisher.show(Made("first"))
    spin_until(lambda: texts == ["first"])
    node.destroy_subscription(subscription)
    spin_until(lambda: node.count_subscribers("look") == 0)
    second = Made("second")
    publisher.show(second)
    assert second.count == 0


def test_a_message_that_cannot_be_made_for_a_newcomer_is_logged_and_the_node_goes_on(
    node, publisher, spin_until
):
    def broken():
        raise ZeroDivisionError

    publisher.show(broken)
    texts, _ = listen(node)
    spin_until(lambda: node.count_subscribers("look") == 1)
    publisher.replace(String(data="after"))
    spin_until(lambda: texts == ["after"])
