# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""ROS' own linters, as far as they can be had as wheels; CMakeLists.txt calls all of them."""

from __future__ import annotations

import re
import subprocess
import sysconfig
from pathlib import Path

import pytest
from catkin_pkg.package import parse_package
from own_process import ROOT

SOURCES = ["reflest_core", "reflest_ros", "launch", "scripts", "setup.py"]
"""What is installed, and what builds it; ``make lint`` takes the tests and benchmarks too."""

PROGRAMS = Path(sysconfig.get_path("scripts"))


def lint(program, *arguments):
    return subprocess.run(
        [PROGRAMS / program, *arguments], cwd=ROOT, capture_output=True, text=True
    )


def pep257_options():
    """The options that CMakeLists.txt gives."""
    (call,) = re.findall(r"ament_pep257\(([^)]*)\)", (ROOT / "CMakeLists.txt").read_text())
    return re.findall(r'"([^"]+)"', call)


def test_flake8_finds_nothing():
    done = lint("ament_flake8", "--config", ".ci/ament_flake8.ini", *SOURCES)
    found = [line for line in done.stdout.splitlines() if re.match(r"\S+:\d+:", line)]
    assert done.returncode == 0, "\n".join(found) or done.stderr


def test_pep257_finds_nothing():
    done = lint("ament_pep257", *pep257_options(), "--", *SOURCES)
    assert done.returncode == 0, done.stderr[-4000:]


def test_cmakelint_finds_nothing():
    # ament_lint_cmake is cmakelint with lines of up to 140 characters.
    done = lint("cmakelint", "--linelength=140", "CMakeLists.txt")
    assert done.returncode == 0, done.stdout


def test_the_manifest_is_valid():
    package = parse_package(str(ROOT))
    package.validate()
    assert package.package_format == 3


@pytest.mark.parametrize("source", ["flake8", "pep257", "lint_cmake", "xmllint"])
def test_the_manifest_asks_for_the_linters_that_cmake_calls(source):
    package = parse_package(str(ROOT))
    names = {dependency.name for dependency in package.test_depends}
    assert {"ament_lint_auto", f"ament_cmake_{source}"} <= names
