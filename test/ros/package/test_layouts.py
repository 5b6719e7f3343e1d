# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The layouts for RViz and Foxglove name topics that the node has, with a QoS that fits."""

from __future__ import annotations

import ast
import json

import pytest
import yaml
from own_process import ROOT

from reflest_ros.node_reference.descriptions import OUTPUTS
from reflest_ros.node_reference.input_table import input_rows

CONFIG = ROOT / "config"


@pytest.fixture(scope="module")
def topics():
    """Full names of all topics that the node publishes or subscribes with its defaults."""
    inputs = [
        row.default if row.default.startswith("/") else f"/{row.default}" for row in input_rows()
    ]
    return {*OUTPUTS, *inputs}


def rviz_displays():
    return yaml.safe_load((CONFIG / "reflest.rviz").read_text())["Visualization Manager"][
        "Displays"
    ]


def foxglove():
    return json.loads((CONFIG / "foxglove_layout.json").read_text())


def named_topics(value):
    """Every string in a layout that begins like a full topic name, without a message path."""
    if isinstance(value, dict):
        yield from (name for one in value.items() for name in named_topics(list(one)))
    elif isinstance(value, list):
        yield from (name for one in value for name in named_topics(one))
    elif isinstance(value, str) and value.startswith("/"):
        yield value.split(".")[0]


def test_rviz_shows_topics_of_the_node(topics):
    named = [display["Topic"]["Value"] for display in rviz_displays() if "Topic" in display]
    assert set(named) <= topics
    assert {"/reflectance/preview", "/reflectance/voxels", "/reflectance/markers"} <= set(named)


def test_the_launch_file_moves_every_topic_of_rviz_into_the_namespace():
    launch = ast.parse((ROOT / "launch" / "estimator.launch.py").read_text())
    (moved,) = (
        ast.literal_eval(statement.value)
        for statement in launch.body
        if isinstance(statement, ast.Assign) and statement.targets[0].id == "RVIZ_TOPICS"
    )
    named = {display["Topic"]["Value"] for display in rviz_displays() if "Topic" in display}
    assert set(moved) == named


def test_rviz_asks_for_what_is_offered():
    for display in rviz_displays():
        if "Topic" not in display:
            continue
        topic = display["Topic"]
        is_ours = topic["Value"].startswith("/reflectance/")
        assert topic["Reliability Policy"] == ("Reliable" if is_ours else "Best Effort")
        # Only a transient local subscription gets the message of before it came.
        assert topic["Durability Policy"] == ("Transient Local" if is_ours else "Volatile")


def test_rviz_shows_every_namespace_of_the_markers():
    shown = {
        one["Topic"]["Value"]: set(one["Namespaces"])
        for one in rviz_displays()
        if one["Class"].endswith("/MarkerArray")
    }
    assert shown == {
        "/reflectance/markers": {"values", "keyframes", "region"},
        "/reflectance/material_markers": {"materials"},
    }


def test_foxglove_shows_topics_of_the_node(topics):
    named = set(named_topics(foxglove()["configById"]))
    assert named <= topics
    # No display shows colours in floats; the preview beside it is shown.
    assert {*OUTPUTS} - {"/reflectance/environment"} <= named


def test_foxglove_lays_out_exactly_the_panels_it_configures():
    def panels(node):
        return [node] if isinstance(node, str) else panels(node["first"]) + panels(node["second"])

    layout = foxglove()
    assert sorted(panels(layout["layout"])) == sorted(layout["configById"])


def test_plotted_values_are_fields_of_the_message():
    from reflest_ros.msg import BrdfEstimate

    fields = BrdfEstimate.get_fields_and_field_types()
    for path in foxglove()["configById"]["Plot!values"]["paths"]:
        assert path["value"].removeprefix("/reflectance/brdf.").split("[")[0] in fields
