# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The policy allows what the node uses, all of it and nothing else."""

from __future__ import annotations

import os
import subprocess
import sys
from xml.etree import ElementTree

import pytest
from own_process import ROOT

FILE = ROOT / "config" / "sros2_policy.xml"
VIEWER_FILE = ROOT / "config" / "sros2_viewer_policy.xml"


@pytest.mark.parametrize(("words", "file"), [([], FILE), (["viewer"], VIEWER_FILE)])
def test_the_policy_is_up_to_date(domain_id, words, file):
    done = subprocess.run(
        [sys.executable, "-m", "reflest_ros.security_policy", *words],
        cwd=ROOT,
        env={**os.environ, "ROS_DOMAIN_ID": str(domain_id)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == file.read_text(), (
        f"run python -m reflest_ros.security_policy {' '.join(words)} > config/{file.name}"
    )


def test_the_viewer_asks_only_for_what_the_node_answers():
    answered = {one.text for one in ElementTree.parse(FILE).iterfind(".//services[@reply]/service")}
    asked = ElementTree.parse(VIEWER_FILE).iterfind(".//services[@request]/service")
    assert {one.text for one in asked} <= answered


def test_every_service_of_the_node_is_in_the_policy(node, peer):
    """As the graph shows them: no service hides in another node."""
    peer.wait_until(lambda: peer.state == "scanning", "the node is not discovered")
    peer.wait_until(lambda: peer.has_service("estimate"), "its services are not discovered")
    names = peer._node.get_node_names
    peer.wait_until(lambda: "reflest_estimator" in names(), "its name is not discovered")
    graph = peer._node.get_service_names_and_types_by_node("reflest_estimator", "/")
    allowed = {one.text for one in ElementTree.parse(FILE).iter("service")}
    assert {name.removeprefix("/") for name, _ in graph} == allowed
