# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Pausing, exporting and moving the region of interest, while frames are fused.

The tests share one node; each sends views with stamps after all before it.
"""

from __future__ import annotations

import dataclasses
import json
import threading

import pytest
from geometry_msgs.msg import Point, Vector3
from rcl_interfaces.msg import ParameterType, ParameterValue
from ros_peer import WAIT
from sphere_messages import RGB, messages_of
from sphere_scene import CENTRE, PERIOD_NS, views
from std_srvs.srv import Trigger

from reflest_core.export.environment_file import LIGHT_FORMATS
from reflest_core.export.exporter import FORMATS
from reflest_ros.srv import Estimate, ExportEstimate, LoadScan, SaveScan, SetRegion


def region_request(shape, centre, size):
    """The fields of a SetRegion request; centre and size: three numbers each."""
    return {
        "shape": shape,
        "centre": Point(**dict(zip("xyz", centre, strict=True))),
        "size": Vector3(**dict(zip("xyz", size, strict=True))),
    }


SPHERE = region_request(SetRegion.Request.SHAPE_SPHERE, (0.0, 0.0, 0.12), (0.35, 0.35, 0.35))


@pytest.fixture(scope="module")
def send(node, peer):
    """Send a number of views that go on in time, and do not wait for them."""
    known = list(views(12))
    sent = 0

    def some(count):
        nonlocal sent
        for _ in range(count):
            sent += 1
            stamp_ns = known[0].stamp_ns + sent * PERIOD_NS
            view = dataclasses.replace(known[sent % len(known)], stamp_ns=stamp_ns)
            for topic, message in messages_of(view):
                peer.publish(topic, message)
        return sent

    return some


def test_pause_in_mid_fusion_keeps_the_scan_and_resume_goes_on(peer, send):
    sent = send(12)
    peer.wait_for_count("frames fused", 1)
    paused = peer.call(Trigger, "pause")
    assert paused.success, paused.message
    peer.wait_until(lambda: peer.state == "paused", "it does not say so")
    peer.wait_until(lambda: not peer.is_heard(RGB), "it still listens")
    fused, voxels = peer.count("frames fused"), peer.count("voxels")
    assert 0 < fused <= sent
    assert voxels > 0
    assert "already" in peer.call(Trigger, "pause").message
    assert peer.call(Estimate, "estimate").success

    assert peer.call(Trigger, "resume").success
    assert "already" in peer.call(Trigger, "resume").message
    send(3)
    peer.wait_for_count("frames fused", fused + 3)
    assert peer.count("voxels") >= voxels


@pytest.mark.parametrize("format_name", FORMATS)
def test_export_writes_a_sphere_of_what_is_estimated_now(peer, send, tmp_path, format_name):
    send(2)
    path = tmp_path / f"material{FORMATS[format_name].suffixes[0]}"
    response = peer.call(ExportEstimate, "export", format=f"sphere-{format_name}", path=str(path))
    assert response.success, response.message
    assert str(path) in response.message
    content = path.read_bytes()
    assert content
    if format_name == "gltf":
        (material,) = json.loads(content)["materials"]
        written = material["extras"]["reflest"]["rho_d"]
        peer.wait_until(
            lambda: any(list(one.rho_d) == written for one in peer.estimates),
            "what was written was not published",
        )


@pytest.mark.parametrize("format_name", ["gltf", "obj", "usd"])
def test_export_writes_the_scanned_surface(peer, send, tmp_path, format_name):
    send(6)
    path = tmp_path / f"scan{FORMATS[format_name].suffixes[0]}"
    response = peer.call(ExportEstimate, "export", format=format_name, path=str(path))
    assert response.success, response.message
    assert "faces" in response.message
    assert path.stat().st_size > 1000
    if format_name == "gltf":
        tree = json.loads(path.read_bytes())
        vertices = tree["accessors"][tree["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
        assert vertices["count"] > 100
        size = [high - low for low, high in zip(vertices["min"], vertices["max"], strict=True)]
        assert max(size) < 0.5


@pytest.mark.parametrize("format_name", LIGHT_FORMATS)
def test_export_writes_the_light_that_was_seen(peer, send, tmp_path, format_name):
    send(2)
    path = tmp_path / f"light{LIGHT_FORMATS[format_name]}"
    response = peer.call(ExportEstimate, "export", format=format_name, path=str(path))
    assert response.success, response.message
    assert "was seen" in response.message
    assert path.stat().st_size > 128 * 256 * 4


@pytest.mark.parametrize(
    ("format_name", "name", "reason"),
    [
        ("hdr", "light.exr", ".hdr"),
        ("vrml", "material.vrml", "gltf"),
        ("gltf", "material.obj", ".gltf"),
        ("sphere-hdr", "light.hdr", "sphere-glb"),
        ("sphere-gltf", "material.obj", ".gltf"),
        ("gltf", "", "path is empty"),
        ("gltf", "no/such/folder/material.gltf", "no/such/folder does not exist"),
    ],
)
def test_a_bad_export_is_refused_with_the_reason(peer, send, tmp_path, format_name, name, reason):
    path = str(tmp_path / name) if name else ""
    response = peer.call(ExportEstimate, "export", format=format_name, path=path)
    assert not response.success
    assert reason in response.message
    assert not list(tmp_path.iterdir())


def test_another_region_begins_a_new_scan_in_mid_fusion(peer, send, tmp_path):
    saved = tmp_path / "before.reflest"
    send(6)
    assert peer.call(SaveScan, "save", path=str(saved)).success
    same = peer.call(SetRegion, "set_region", **SPHERE)
    assert same.success
    assert "already" in same.message
    whole = peer.call(Estimate, "estimate").estimate

    # A box around the upper half of the sphere, whose views are all new.
    send(3)
    box = region_request(SetRegion.Request.SHAPE_BOX, (0.0, 0.0, 0.2), (0.4, 0.4, 0.16))
    changed = peer.call(SetRegion, "set_region", **box)
    assert changed.success, changed.message
    assert peer.parameter("region.shape").string_value == "box"
    assert list(peer.parameter("region.size").double_array_value) == [0.4, 0.4, 0.16]
    fused = peer.count("frames fused")
    send(2)
    peer.wait_for_count("frames fused", fused + 2)
    upper = peer.call(Estimate, "estimate")
    assert upper.success, upper.message
    assert 0 < upper.estimate.view_count < whole.view_count

    # A loaded scan brings its region with it.
    assert peer.call(LoadScan, "load", path=str(saved)).success
    assert peer.parameter("region.shape").string_value == "sphere"
    again = peer.call(Estimate, "estimate").estimate
    assert (again.voxel_count, again.view_count) == (whole.voxel_count, whole.view_count)


def test_a_bad_region_is_refused_and_the_scan_kept(peer, send):
    send(2)
    voxels = peer.call(Estimate, "estimate").estimate.voxel_count
    for bad, reason in (
        ({**SPHERE, "shape": 9}, "shape = 9 is none of"),
        ({**SPHERE, "size": Vector3(x=-1.0, y=1.0, z=1.0)}, "size"),
        ({**SPHERE, "size": Vector3()}, "a sphere needs a diameter"),
        (region_request(SetRegion.Request.SHAPE_BOX, (0.0,) * 3, (0.0,) * 3), "a box needs every"),
        ({**SPHERE, "centre": Point(x=float("nan"))}, "centre"),
    ):
        response = peer.call(SetRegion, "set_region", **bad)
        assert not response.success
        assert reason in response.message
    assert peer.call(Estimate, "estimate").estimate.voxel_count == voxels
    assert list(peer.parameter("region.centre").double_array_value) == CENTRE.tolist()


def test_the_region_parameters_are_the_same_region(peer, send):
    value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="none")
    assert peer.set_parameter("region.shape", value).successful
    peer.wait_until(lambda: peer.diagnostics["voxels"] == "0", "the old scan is left")
    assert peer.call(SetRegion, "set_region", **SPHERE).success
    assert peer.parameter("region.shape").string_value == "sphere"


def test_every_service_while_frames_come(peer, send, tmp_path):
    """Services in any order amid frames: each answers, and the scan goes on after them."""
    scan, material = str(tmp_path / "scan.reflest"), str(tmp_path / "material.gltf")
    assert peer.call(SaveScan, "save", path=scan).success
    feeding = threading.Thread(target=send, args=(60,))
    feeding.start()
    calls = [
        (Trigger, "reset", {}),
        (Estimate, "estimate", {}),
        (SaveScan, "save", {"path": scan}),
        (LoadScan, "load", {"path": scan}),
        (ExportEstimate, "export", {"format": "gltf", "path": material}),
        (SetRegion, "set_region", {**SPHERE, "size": Vector3(x=0.3, y=0.3, z=0.3)}),
        (Trigger, "pause", {}),
        (Trigger, "resume", {}),
        (SetRegion, "set_region", SPHERE),
    ]
    for number in range(3 * len(calls)):
        kind, name, request = calls[number * 2 % len(calls)]
        response = peer.call(kind, name, **request)
        # An estimate may find an empty scan; nothing else can fail.
        assert response.success or name in ("estimate", "export"), response.message
    assert peer.call(Trigger, "resume").success
    feeding.join(WAIT)
    assert not feeding.is_alive()
    peer.wait_until(lambda: peer.diagnostics["queue"] == "0", "the queue does not empty")
    fused = peer.count("frames fused")
    send(3)
    peer.wait_for_count("frames fused", fused + 3)
    assert peer.call(Estimate, "estimate").success


def test_the_node_outlived_it_all(node):
    assert node.is_running
    assert "Traceback" not in node.output
