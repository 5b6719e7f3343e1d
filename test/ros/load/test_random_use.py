# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Random transitions, parameters and kills while images come; ``make stress`` does many of them."""

from __future__ import annotations

import dataclasses
import random
import signal
import statistics
import threading
import time

import pytest
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from ros_peer import RosPeer
from sphere_messages import messages_of
from sphere_scene import PERIOD_NS, views

from reflest_ros.srv import Estimate
from test.stress import repeats

TRANSITIONS = repeats(40, 500)
PARAMETER_SETS = repeats(60, 2000)
KILLS = repeats(2, 100)
MEDIAN = 5.0
"""Seconds for half of the answers on a machine that does much else; 1 s for any on an idle one."""

VALID = {
    "active": {4: "inactive"},
    "inactive": {3: "active", 2: "unconfigured"},
    "unconfigured": {1: "inactive"},
}


@pytest.fixture
def images(node, peer):
    """Images come for the whole test, whether anyone listens or not."""
    is_over = threading.Event()
    known = list(views(12))
    outputs = {
        topic: peer.offer(type(message), topic, 10) for topic, message in messages_of(known[0])
    }

    def send():
        count = 0
        while not is_over.wait(0.05):
            count += 1
            stamp_ns = known[0].stamp_ns + count * PERIOD_NS
            view = dataclasses.replace(known[count % 12], stamp_ns=stamp_ns)
            for topic, message in messages_of(view):
                outputs[topic].publish(message)

    thread = threading.Thread(target=send, daemon=True)
    thread.start()
    yield
    is_over.set()
    thread.join()
    for output in outputs.values():
        peer.withdraw(output)


def state(peer):
    return peer.call(GetState, "get_state").current_state.label


@pytest.mark.timeout(3600)
def test_random_transitions_valid_or_not(node, peer, images):
    choice = random.Random(1)
    now, seconds = state(peer), []
    for _ in range(TRANSITIONS):
        number = choice.choice([1, 2, 3, 4, 3, 4, 0, 10, 60, 99])
        asked = time.monotonic()
        answer = peer.call(ChangeState, "change_state", transition=Transition(id=number))
        seconds.append(time.monotonic() - asked)
        assert answer.success == (number in VALID[now]), (now, number)
        now = VALID[now].get(number, now)
        assert state(peer) == now
    for number in {"unconfigured": (1, 3), "inactive": (3,), "active": ()}[now]:
        assert peer.call(ChangeState, "change_state", transition=Transition(id=number)).success
    assert statistics.median(seconds) < MEDIAN
    assert "Traceback" not in node.output


def value(number):
    if isinstance(number, bool):
        return ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=number)
    if isinstance(number, int):
        return ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=number)
    if isinstance(number, float):
        return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=number)
    if isinstance(number, str):
        return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=number)
    kind = ParameterType.PARAMETER_DOUBLE_ARRAY
    return ParameterValue(type=kind, double_array_value=list(number))


NAN, INF = float("nan"), float("inf")
CHOICES = {
    "preview.size": (31, 32, 100, 512, 513),
    "voxels.colour": ("observed", "views", "estimate", "x"),
    "voxels.max_points": (99, 100, 10_000, "x"),
    "environment.height": (15, 16, 512),
    "markers.frustum": (0.0, 0.001, 10.0, NAN, INF),
    "materials.when": ("always", "never", "sometimes"),
    "region.shape": ("none", "box", "sphere", "cone"),
    "region.centre": ((0.0, 0.0, 0.1), (1e308, 0.0, 0.0), (NAN,) * 3, ()),
    "region.size": ((0.35,) * 3, (0.0,) * 3, (-1.0,) * 3, (INF,) * 3),
    "keyframe.translation": (0.001, 0.2, 100.0, -1.0),
    "keyframe.interval": (0.01, 1.0, NAN, True),
    "estimation.model": ("lightnet", "hemicnn", "nope"),
    "estimation.weights": ("", "/nope", "/etc/passwd"),
    "estimation.up": ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (1e-300, 0.0, 0.0)),
    "estimation.known_light": ("", "/nope.hdr"),
    "estimation.min_voxels": (1, 10, 1000, 0),
    "fusion.voxel_size": (0.02, 5.0),
    "autosave.path": ("/tmp/x",),
    "files.root": ("/",),
}


@pytest.mark.timeout(3600)
def test_random_parameters_alone_and_together(node, peer, images):
    choice = random.Random(7)
    refused = accepted = 0
    for _ in range(PARAMETER_SETS):
        names = choice.sample(list(CHOICES), choice.choice([1, 1, 2, 3]))
        sent = [Parameter(name=n, value=value(choice.choice(CHOICES[n]))) for n in names]
        if choice.random() < 0.4:
            answer = peer.call(
                SetParametersAtomically, "set_parameters_atomically", parameters=sent
            )
            results = [answer.result]
        else:
            results = peer.call(SetParameters, "set_parameters", parameters=sent).results
        for result in results:
            accepted += result.successful
            refused += not result.successful
            assert result.successful or result.reason
    assert accepted > PARAMETER_SETS / 10
    assert refused > PARAMETER_SETS / 10
    assert state(peer) == "active"
    assert "Traceback" not in node.output


@pytest.mark.timeout(7200)
def test_a_scan_outlives_every_kill(start, settings_file, tmp_path, domain_id):
    """Killed at a random time, the next start has what was saved last, and nothing is broken."""
    path, choice = tmp_path / "scan", random.Random(3)
    known = list(views(12))
    sent = 0
    for _ in range(KILLS):
        node = start(
            "reflest_ros.estimator",
            "--ros-args",
            "--params-file",
            settings_file,
            "-p",
            f"autosave.path:={path}",
            "-p",
            "autosave.period:=0.1",
            "-r",
            "__ns:=/killed",
        )
        node.wait_for_line("listening to", 600.0)
        assert "damaged" not in node.output
        assert "resumed" in node.output or not sent
        peer = RosPeer(domain_id, "/killed")
        try:
            count = choice.randrange(3, 9)
            for _ in range(count):
                sent += 1
                stamp_ns = known[0].stamp_ns + sent * PERIOD_NS
                view = dataclasses.replace(known[sent % 12], stamp_ns=stamp_ns)
                for topic, message in messages_of(view):
                    peer.publish(f"/killed{topic}", message)
            peer.wait_for_count("messages rgb", count)
            peer.wait_for_count("frames fused", 1)
            assert peer.call(Estimate, "estimate").success
            peer.wait_until(path.exists, "nothing was saved")
            time.sleep(choice.random() * 0.3)
        finally:
            node.interrupt(signal.SIGKILL)
            node.exit_code()
            peer.close()
    assert not list(tmp_path.glob("*.damaged*"))
