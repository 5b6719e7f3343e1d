# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The managed node: what each transition gives and takes."""

from __future__ import annotations

from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.msg import ParameterType, ParameterValue
from sphere_messages import RGB, messages_of
from sphere_scene import views


def change(peer, transition):
    request = Transition(id=transition)
    return peer.call(ChangeState, "change_state", transition=request).success


def state(peer):
    return peer.call(GetState, "get_state").current_state.id


def send(peer, some):
    before = peer.count("frames fused")
    for view in some:
        for topic, message in messages_of(view):
            peer.publish(topic, message)
    peer.wait_for_count("frames fused", before + len(some))


def test_every_transition(start, peer, settings_file):
    node = start(
        "reflest_ros.estimator",
        "--ros-args",
        "--params-file",
        settings_file,
        "-p",
        "lifecycle.autostart:=false",
        "-p",
        "estimation.weights:=/no/such/weights",
    )
    node.wait_for_line("waiting to be configured", 600.0)
    assert state(peer) == State.PRIMARY_STATE_UNCONFIGURED
    peer.wait_until(lambda: peer.state == "not configured", "it does not say so")

    # A configuration that fails says why, and another may follow.
    assert not change(peer, Transition.TRANSITION_CONFIGURE)
    assert "/no/such/weights" in node.wait_for_line("ERROR")
    assert state(peer) == State.PRIMARY_STATE_UNCONFIGURED
    shipped = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="")
    assert peer.set_parameter("estimation.weights", shipped).successful
    assert change(peer, Transition.TRANSITION_CONFIGURE)
    assert state(peer) == State.PRIMARY_STATE_INACTIVE
    assert peer.has_service("estimate")

    assert change(peer, Transition.TRANSITION_ACTIVATE)
    first, second = list(views(8))[:4], list(views(8))[4:]
    send(peer, first)

    # Deactivated, it listens to nothing and keeps the scan.
    assert change(peer, Transition.TRANSITION_DEACTIVATE)
    peer.wait_until(lambda: not peer.is_heard(RGB), "it still listens")
    peer.wait_until(lambda: peer.state == "paused", "it does not say so")
    voxels = peer.count("voxels")
    assert voxels > 0
    assert change(peer, Transition.TRANSITION_ACTIVATE)
    send(peer, second)
    assert peer.count("voxels") >= voxels

    # Cleaned up, it holds nothing, and can begin again.
    assert change(peer, Transition.TRANSITION_DEACTIVATE)
    assert change(peer, Transition.TRANSITION_CLEANUP)
    peer.wait_until(lambda: peer.state == "not configured", "it does not say so")
    peer.wait_until(lambda: not peer.has_service("estimate"), "the services are left")
    assert change(peer, Transition.TRANSITION_CONFIGURE)
    peer.wait_until(lambda: peer.diagnostics.get("voxels") == "0", "the scan is left")

    assert change(peer, Transition.TRANSITION_INACTIVE_SHUTDOWN)
    assert state(peer) == State.PRIMARY_STATE_FINALIZED
    node.interrupt()
    assert node.exit_code() == 0, node.output
    assert "Traceback" not in node.output
