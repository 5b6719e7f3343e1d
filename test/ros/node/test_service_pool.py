# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Services in threads of their own hold up nothing, and no exception of theirs goes further."""

from __future__ import annotations

import threading

import pytest
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger

from reflest_ros import threads
from reflest_ros.services.service_pool import ServicePool
from reflest_ros.threads import Spinning

SOON = 120.0


@pytest.fixture
def context(domain_id):
    context = rclpy.Context()
    arguments = ["--ros-args", "-r", "__node:=scanner", "-r", "__ns:=/robot"]
    rclpy.init(args=arguments, context=context, domain_id=domain_id)
    yield context
    rclpy.try_shutdown(context=context)


@pytest.fixture
def owner(context):
    """A node that spins, with a pool and what crashed."""
    node = Node("estimator", context=context)
    crashes = []
    pool = ServicePool(node, "pool", 2, crashes.append)
    executor = EventsExecutor(context=context)
    executor.add_node(node)
    spinning = Spinning(executor, "owner", crashes.append)
    pool.start()
    spinning.start()
    yield node, pool
    pool.stop()
    spinning.stop()
    node.destroy_node()
    assert not crashes


def ask(node, name):
    """Call a service; the event is set when the answer is there."""
    client = node.create_client(Trigger, name)
    assert client.wait_for_service(SOON)
    answered = threading.Event()
    future = client.call_async(Trigger.Request())
    future.add_done_callback(lambda _: answered.set())
    return future, answered


def test_a_service_that_waits_holds_up_nothing_of_its_owner(owner):
    node, pool = owner
    asked, may_answer, ticked_meanwhile = (threading.Event() for _ in range(3))
    ticks = []

    def on_tick():
        ticks.append(asked.is_set())
        if sum(ticks) > 5:
            ticked_meanwhile.set()

    def answer(_, response):
        asked.set()
        may_answer.wait(SOON)
        response.success = True
        return response

    pool.create(Trigger, "~/slow", answer)
    node.create_timer(0.02, on_tick)
    try:
        future, answered = ask(node, "/robot/scanner/slow")
        assert asked.wait(SOON)
        assert ticked_meanwhile.wait(SOON)
        assert not answered.is_set()
    finally:
        may_answer.set()
    assert answered.wait(SOON)
    assert future.result().success


def test_the_services_are_the_nodes_own_and_no_other_node_is_made(owner):
    node, pool = owner
    pool.create(Trigger, "~/mine", lambda _, response: response)
    name, namespace = node.get_name(), node.get_namespace()
    offered = dict(node.get_service_names_and_types_by_node(name, namespace))
    assert "/robot/scanner/mine" in offered
    assert node.get_node_names_and_namespaces() == [(name, namespace)]


def test_an_exception_is_an_answer(owner):
    node, pool = owner
    pool.create(Trigger, "~/broken", lambda *_: 1 / 0)
    for _ in range(2):
        future, answered = ask(node, "/robot/scanner/broken")
        assert answered.wait(SOON)
        assert not future.result().success
        assert "ZeroDivisionError" in future.result().message


def test_a_service_that_was_withdrawn_is_gone(owner):
    node, pool = owner
    pool.create(Trigger, "~/mine", lambda _, response: response)
    pool.withdraw(pool.services)
    offered = dict(node.get_service_names_and_types_by_node(node.get_name(), node.get_namespace()))
    assert "/robot/scanner/mine" not in offered


@pytest.mark.timeout(300)
@pytest.mark.parametrize("kind", [MultiThreadedExecutor, EventsExecutor])
def test_a_thread_that_waits_for_callbacks_ends_at_once(context, kind, monkeypatch):
    monkeypatch.setattr(threads, "LONGEST_WAIT", 600.0)
    node, executor = Node("idle", context=context), kind(context=context)
    executor.add_node(node)
    called = threading.Event()
    timer = node.create_timer(0.01, called.set)
    spinning = Spinning(executor, "idle", lambda _: None)
    spinning.start()
    assert called.wait(SOON)
    timer.cancel()
    spinning.stop()
    node.destroy_node()
