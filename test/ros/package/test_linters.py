# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""ROS' own linters, as far as they can be had as wheels; CMakeLists.txt calls all of them."""

from __future__ import annotations

import re

import pytest
from catkin_pkg.package import parse_package
from own_process import ROOT


def outcome(process):
    """Exit code and output of a linter that was started with the first test of this folder."""
    output, _ = process.communicate()
    return process.returncode, output


def test_flake8_finds_nothing(linters):
    code, output = outcome(linters["ament_flake8"])
    found = [line for line in output.splitlines() if re.match(r"\S+:\d+:", line)]
    assert code == 0, "\n".join(found) or output


def test_pep257_finds_nothing(linters):
    code, output = outcome(linters["ament_pep257"])
    assert code == 0, output[-4000:]


def test_cmakelint_finds_nothing(linters):
    code, output = outcome(linters["cmakelint"])
    assert code == 0, output


def test_the_manifest_is_valid():
    package = parse_package(str(ROOT))
    package.validate()
    assert package.package_format == 3


@pytest.mark.parametrize("source", ["flake8", "pep257", "lint_cmake", "xmllint"])
def test_the_manifest_asks_for_the_linters_that_cmake_calls(source):
    package = parse_package(str(ROOT))
    names = {dependency.name for dependency in package.test_depends}
    assert {"ament_lint_auto", f"ament_cmake_{source}"} <= names
