# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The parameter files of the cameras, and the launch file that chooses among them."""

from __future__ import annotations

import ast
import importlib.util
import os
import shutil
import signal
import subprocess
import sys

import pytest
import rclpy
import yaml
from conftest import COMPILE_TIME
from own_process import ROOT
from rclpy.context import Context
from rclpy.node import Node
from sphere_messages import RGB

from reflest_core.estimation.settings import ReflestSettings
from reflest_ros.bag_player import namespace_remaps
from reflest_ros.parameters import declare_parameters
from reflest_ros.settings import NODE_NAME

LAUNCH = ROOT / "launch" / "estimator.launch.py"
CAMERAS = ("realsense", "azure_kinect", "orbbec", "tum")


def leaves(path):
    """Full names and values of a parameter file."""
    groups = yaml.safe_load(path.read_text())["/**"]["ros__parameters"]
    return {f"{g}.{name}": value for g, group in groups.items() for name, value in group.items()}


@pytest.fixture
def declared(request):
    """A node that was given a camera's file after the base file, as the launch file does."""
    context = Context()
    files = [ROOT / "config" / f"{name}.yaml" for name in ("estimator", request.param)]
    given = [word for path in files for word in ("--params-file", str(path))]
    rclpy.init(args=["--ros-args", *given], context=context)
    node = Node("camera_file", context=context)
    yield leaves(files[1]), node, declare_parameters(node)
    node.destroy_node()
    context.try_shutdown()


@pytest.mark.parametrize("declared", CAMERAS, indirect=True)
def test_a_camera_file_sets_every_parameter_that_it_names(declared):
    values, node, (node_settings, settings) = declared
    assert {name: node.get_parameter(name).value for name in values} == values
    for role in ("rgb", "depth", "camera_info"):
        topic = values[f"topics.{role}"]
        assert getattr(node_settings.topics, role) == topic
        assert not topic.startswith("/"), "an absolute topic cannot be put into a namespace"
    assert settings.capture.depth_scale == values["capture.depth_scale"]
    assert settings.capture.pose_source == "tf"


@pytest.mark.parametrize("camera", CAMERAS)
def test_replay_reads_the_same_file(camera):
    path = ROOT / "config" / f"{camera}.yaml"
    settings = ReflestSettings.from_yaml(path)
    assert settings.capture.world_frame == leaves(path)["capture.world_frame"]


@pytest.mark.parametrize("camera", CAMERAS)
def test_the_node_listens_to_the_topics_of_its_camera(camera, start, peer, tmp_path):
    """Started with the files in the order of the launch file; poses come from a topic here."""
    own = tmp_path / "own.yaml"
    own.write_text("/**: {ros__parameters: {capture: {pose_source: pose}}}")
    files = [*(ROOT / "config" / f"{name}.yaml" for name in ("estimator", camera)), own]
    given = [word for path in files for word in ("--params-file", path)]
    node = start("reflest_ros.estimator", "--ros-args", *given)
    line = node.wait_for_line("listening to", COMPILE_TIME)
    values = leaves(files[1])
    for role in ("rgb", "depth", "camera_info"):
        assert f"/{values[f'topics.{role}']}" in line
        assert peer.has_subscriber(f"/{values[f'topics.{role}']}")
    node.interrupt()
    assert node.exit_code() == 0, node.output


def test_a_bag_is_moved_into_the_namespace_of_its_node(sphere_bag):
    remaps = dict(one.split(":=") for one in namespace_remaps(sphere_bag, "robot1"))
    assert remaps[RGB] == f"/robot1{RGB}"
    assert not {"/tf", "/tf_static", "/clock"} & set(remaps)
    assert namespace_remaps(sphere_bag, "") == namespace_remaps(sphere_bag, "/") == []


def test_the_launch_file_launches_the_node(domain_id, tmp_path):
    """Where launch_ros is installed: it comes up, and ends with the launch."""
    if shutil.which("ros2") is None:
        pytest.skip("ros2 launch comes with an apt installation")
    environment = {**os.environ, "ROS_DOMAIN_ID": str(domain_id)}
    command = ["ros2", "launch", str(LAUNCH), "camera:=tum", "log_level:=info"]
    with subprocess.Popen(
        command, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as running:
        seen = []
        for text in running.stdout:
            seen.append(text)
            if "listening to" in text or "pose_source is tf" in text:
                break
        running.send_signal(signal.SIGINT)
    assert any("reflest_estimator" in text for text in seen), seen


@pytest.fixture
def launched(monkeypatch):
    """What the launch file makes of arguments, where launch_ros is installed."""
    launch = pytest.importorskip("launch", reason="launch comes with an apt installation")
    pytest.importorskip("launch_ros", reason="launch_ros comes with an apt installation")
    spec = importlib.util.spec_from_file_location("estimator_launch", LAUNCH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)

    def made(**given):
        context = launch.LaunchContext()
        for name, default, *_ in module.ARGUMENTS:
            context.launch_configurations[name] = given.get(name, default)
        return module.nodes(context)

    return made


def test_the_viewer_is_launched_beside_the_estimator_where_it_is_asked_for(launched):
    (alone,) = launched()
    assert alone.node_executable == "estimator"
    estimator, viewer = launched(viewer="true", viewer_host="0.0.0.0", namespace="robot1")
    assert (estimator.node_executable, viewer.node_executable) == ("estimator", "viewer")


def test_without_what_the_viewer_needs_nothing_is_launched(launched, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(RuntimeError, match="viewer:=true needs the Python packages viser: run"):
        launched(viewer="true")


def constants(tree):
    return [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]


def test_the_launch_file_names_what_is_there():
    tree = ast.parse(LAUNCH.read_text())
    (choices,) = (
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and node.targets[0].id == "CAMERAS"
    )
    assert choices == ("none", *CAMERAS)
    strings = [text for text in constants(tree) if isinstance(text, str)]
    for suffix in (".yaml", ".xml", ".rviz"):
        for name in strings:
            if name.endswith(suffix) and len(name) > len(suffix):
                assert (ROOT / "config" / name).is_file(), name
    assert (ROOT / "scripts" / "estimator").is_file()
    assert "scripts/estimator" in (ROOT / "CMakeLists.txt").read_text()
    # Nothing absolute but the topics that RViz's own file names, which are moved.
    rviz = (ROOT / "config" / "reflest.rviz").read_text()
    absolute = [text for text in strings if text.startswith("/") and text not in rviz]
    assert set(absolute) == {"/tf", "/tf_static"}


def test_the_launch_file_launches_the_node_by_its_name():
    (call,) = (
        node
        for node in ast.walk(ast.parse(LAUNCH.read_text()))
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "LifecycleNode"
    )
    given = {word.arg: word.value for word in call.keywords}
    assert ast.literal_eval(given["name"]) == NODE_NAME
    assert ast.literal_eval(given["executable"]) == "estimator"
