# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One list of dependencies, one version, one licence."""

from __future__ import annotations

import re
import tomllib
import xml.etree.ElementTree as ElementTree

import pytest
from own_process import ROOT

import reflest_core

REQUIREMENTS = [
    *sorted((ROOT / "requirements").glob("*.txt")),
    *sorted((ROOT / "reflest_core").glob("requirements*.txt")),
]


@pytest.mark.parametrize("path", REQUIREMENTS, ids=lambda path: path.name)
def test_every_requirement_is_pinned(path):
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    assert lines
    for line in lines:
        assert re.fullmatch(r"[A-Za-z0-9-]+(\[[a-z]+\])?==[0-9][0-9A-Za-z.]*", line), line


def test_versions_and_licences_agree():
    manifest = ElementTree.parse(ROOT / "package.xml").getroot()
    assert manifest.findtext("version") == reflest_core.__version__
    for folder in (ROOT, ROOT / "reflest_core"):
        project = tomllib.loads((folder / "pyproject.toml").read_text())["project"]
        assert project["license"] == manifest.findtext("license") == "Apache-2.0"
        assert "version" in project["dynamic"]


def test_both_distributions_read_the_same_list():
    both = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["dynamic"]
    alone = tomllib.loads((ROOT / "reflest_core" / "pyproject.toml").read_text())["tool"]
    assert "reflest_core/requirements.txt" in both["dependencies"]["file"]
    assert alone["setuptools"]["dynamic"]["dependencies"]["file"] == "requirements.txt"


def test_the_core_never_imports_ros():
    for path in (ROOT / "reflest_core").rglob("*.py"):
        assert not re.search(
            r"^\s*(import|from) (rclpy|reflest_ros|\w+_msgs)", path.read_text(), re.M
        )
