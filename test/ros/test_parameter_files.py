# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest_core.parameter_file`` reads what rclpy reads, and knows the node's own groups."""

import dataclasses
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
import sys, rclpy
from rclpy.node import Node
path, namespace, name = sys.argv[1:]
rclpy.init(args=["--ros-args", "--params-file", path])
node = Node(name, namespace=namespace)
print({name: one.value for name, one in node._parameter_overrides.items()})
rclpy.shutdown()
"""
LISTED = "\n".join(f"    v{index}: {text}" for index, text in enumerate(SCALARS))
TYPES = f"/**:\n  ros__parameters:\n    a.b: 1\n    c: {{d: 1e-3, e.f: x}}\n{LISTED}\n"


def with_rclpy(path, namespace, name):
    done = subprocess.run(
        [sys.executable, "-c", WITH_RCLPY, str(path), namespace, name],
        capture_output=True,
        text=True,
        timeout=600,
        check=True,
    )
    return eval(done.stdout, {"inf": math.inf, "array": lambda _, values: values})


@pytest.mark.parametrize("text", [NODES, TYPES])
@pytest.mark.parametrize("namespace", ["/", "/ns", "/a/b"])
@pytest.mark.parametrize("name", [NODE_NAME, "camera"])
def test_values_are_those_that_rclpy_reads(tmp_path, text, namespace, name):
    path = tmp_path / "p.yaml"
    path.write_text(text)
    full_name = f"{namespace.rstrip('/')}/{name}"
    expected = with_rclpy(path, namespace, name)
    values = read_parameter_file(path, full_name)
    assert values == expected
    assert [type(one) for one in values.values()] == [type(expected[key]) for key in values]


def test_the_replay_knows_the_nodes_name_and_groups():
    assert node_settings.NODE_NAME == NODE_NAME
    assert {group.name for group in dataclasses.fields(NodeSettings)} <= set(NODE_GROUPS)
