# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``docs/node.md`` is what the code and a node that runs give."""

from __future__ import annotations

import dataclasses
import os
import subprocess
import sys

import pytest
from own_process import ROOT

from reflest_core.capture.refusal import RefusalCause
from reflest_ros.inputs.qos import OUTPUT_QOS
from reflest_ros.node_reference.descriptions import CONDITIONAL, DIAGNOSTICS, OUTPUTS
from reflest_ros.node_reference.interface_file import read_interface
from reflest_ros.node_reference.live_node import NodeFacts, OfferedTopic
from reflest_ros.node_reference.page import UndescribedError, page
from reflest_ros.parameters import all_parameters

FACTS = NodeFacts(
    topics=tuple(OfferedTopic(name, "a/msg/B", OUTPUT_QOS) for name in OUTPUTS),
    services=(),
    diagnostics=(
        "messages rgb",
        *(key.replace("ROLE", "rgb") for key in DIAGNOSTICS if key not in CONDITIONAL),
    ),
)


def test_the_page_is_up_to_date(domain_id):
    done = subprocess.run(
        [sys.executable, "-m", "reflest_ros.node_reference"],
        cwd=ROOT,
        env={**os.environ, "ROS_DOMAIN_ID": str(domain_id)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert (ROOT / "docs" / "node.md").read_text() == done.stdout, (
        "run python -m reflest_ros.node_reference > docs/node.md"
    )


def test_every_parameter_is_on_the_page():
    text = page(FACTS)
    for parameter in all_parameters():
        assert f"| `{parameter.name}` |" in text
    for cause in RefusalCause:
        assert f"| `{cause.value}` |" in text


@pytest.mark.parametrize("change", ["more", "fewer"])
def test_a_topic_that_nobody_described_is_an_error(change):
    topics = FACTS.topics[1:]
    if change == "more":
        topics = (*FACTS.topics, OfferedTopic("/reflectance/new", "a/msg/B", OUTPUT_QOS))
    with pytest.raises(UndescribedError, match=r"correct .*descriptions\.py"):
        page(dataclasses.replace(FACTS, topics=topics))


def test_a_diagnostic_that_nobody_described_is_an_error():
    keys = (*FACTS.diagnostics, "mood rgb")
    with pytest.raises(UndescribedError, match="the diagnostic mood ROLE is"):
        page(dataclasses.replace(FACTS, diagnostics=keys))


def test_an_interface_file_is_read_with_its_comments(tmp_path):
    path = tmp_path / "Scan.srv"
    path.write_text(
        "# Copyright us\n# SPDX: x\n\n# What it is\n# for.\n\n# Which.\nstring<=8 name\n---\n"
        "# None.\nuint8 NONE=0\n# How many.\n# Range: all.\nuint8 count\n"
    )
    request, response = read_interface(path)
    assert (request.comment, response.comment) == ("What it is for.", "")
    (name,) = request.fields
    assert (name.kind, name.name, name.value, name.comment) == ("string<=8", "name", "", "Which.")
    none, count = response.fields
    assert (none.name, none.value) == ("NONE", "0")
    assert count.comment == "How many. Range: all."


def test_an_unreadable_line_is_named(tmp_path):
    path = tmp_path / "Bad.msg"
    path.write_text("what is this\n")
    with pytest.raises(ValueError, match="what is this"):
        read_interface(path)
