# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest_core.parameter_file`` reads what rclpy reads, and knows the node's own groups."""

import dataclasses
import json
import math
import subprocess
import sys

import pytest

from reflest_core.estimation.settings import NODE_GROUPS
from reflest_core.parameter_file import NODE_NAME, read_parameter_file
from reflest_ros import settings as node_settings
from reflest_ros.settings import NodeSettings
from test.core.test_parameter_file import NODES, SCALARS

WITH_RCLPY = """
import json, sys, rclpy
from rclpy.context import Context
from rclpy.node import Node
for path, namespace, name in json.load(sys.stdin):
    context = Context()
    rclpy.init(args=["--ros-args", "--params-file", path], context=context)
    node = Node(name, namespace=namespace, context=context)
    print({name: one.value for name, one in node._parameter_overrides.items()})
    rclpy.shutdown(context=context)
"""
LISTED = "\n".join(f"    v{index}: {text}" for index, text in enumerate(SCALARS))
TYPES = f"/**:\n  ros__parameters:\n    a.b: 1\n    c: {{d: 1e-3, e.f: x}}\n{LISTED}\n"


NAMESPACES = ("/", "/ns", "/a/b")
NAMES = (NODE_NAME, "camera")


@pytest.fixture(scope="module")
def by_rclpy(tmp_path_factory):
    """What nodes of one process are given: by text, namespace and name, with the text's file."""
    cases, files = [], {}
    for number, text in enumerate((NODES, TYPES)):
        files[text] = tmp_path_factory.mktemp("parameters") / f"{number}.yaml"
        files[text].write_text(text)
        cases += [(text, namespace, name) for namespace in NAMESPACES for name in NAMES]
    done = subprocess.run(
        [sys.executable, "-c", WITH_RCLPY],
        input=json.dumps([(str(files[text]), *rest) for text, *rest in cases]),
        capture_output=True,
        text=True,
        timeout=600,
        check=True,
    )
    values = [
        eval(line, {"inf": math.inf, "array": lambda _, values: values})
        for line in done.stdout.splitlines()
    ]
    return dict(zip(cases, values, strict=True)), files


@pytest.mark.parametrize("text", [NODES, TYPES])
@pytest.mark.parametrize("namespace", NAMESPACES)
@pytest.mark.parametrize("name", NAMES)
def test_values_are_those_that_rclpy_reads(by_rclpy, text, namespace, name):
    given, files = by_rclpy
    full_name = f"{namespace.rstrip('/')}/{name}"
    expected = given[text, namespace, name]
    values = read_parameter_file(files[text], full_name)
    assert values == expected
    assert [type(one) for one in values.values()] == [type(expected[key]) for key in values]


def test_the_replay_knows_the_nodes_name_and_groups():
    assert node_settings.NODE_NAME == NODE_NAME
    assert {group.name for group in dataclasses.fields(NodeSettings)} <= set(NODE_GROUPS)
