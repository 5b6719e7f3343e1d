# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Services that wait: under the estimator's name, beside its executor, taken away whole."""

import threading

import pytest
import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger

from reflest_ros.services.waiting_services import WaitingServices
from reflest_ros.spinning import Spinning

SOON = 20.0


@pytest.fixture
def context(domain_id):
    context = rclpy.Context()
    rclpy.init(
        args=["--ros-args", "-r", "__node:=scanner", "-r", "__ns:=/robot"],
        context=context,
        domain_id=domain_id,
    )
    yield context
    rclpy.try_shutdown(context=context)


def test_a_service_that_waits_holds_up_nothing_of_its_owner(context):
    owner = Node("estimator", context=context)
    crashes, asked, may_answer = [], threading.Event(), threading.Event()
    ticks, ticked_meanwhile = [], threading.Event()

    def on_tick():
        ticks.append(asked.is_set())
        if sum(ticks) > 5:
            ticked_meanwhile.set()

    def answer(_, response):
        asked.set()
        may_answer.wait(SOON)
        response.success = True
        return response

    waiting = WaitingServices(owner, crashes.append)
    waiting.create(Trigger, "~/slow", answer)
    waiting.start()
    client = owner.create_client(Trigger, "/robot/scanner/slow")
    owner.create_timer(0.02, on_tick)
    executor = EventsExecutor(context=context)
    executor.add_node(owner)
    spinning = Spinning(executor, "owner", crashes.append)
    spinning.start()
    try:
        assert client.wait_for_service(SOON)
        answered = threading.Event()
        client.call_async(Trigger.Request()).add_done_callback(lambda _: answered.set())
        assert asked.wait(SOON)
        assert ticked_meanwhile.wait(SOON)
        assert not answered.is_set()
        may_answer.set()
        assert answered.wait(SOON)
        # Hidden (its name begins with _), and not renamed to its owner's name.
        assert ("_scanner_services", "/robot") in owner.get_node_names_and_namespaces()
    finally:
        may_answer.set()
        waiting.close()
        spinning.stop()
        owner.destroy_node()
    assert not crashes
