# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One list of dependencies, one version, one licence."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tomllib
import xml.etree.ElementTree as ElementTree

import pytest
import yaml
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
        assert re.fullmatch(r"[A-Za-z0-9_-]+(\[[a-z]+\])?==[0-9][0-9A-Za-z.]*", line), line


def locked(name):
    """Version by package of a lock file; each package has hashes."""
    text = (ROOT / "requirements" / "lock" / name).read_text()
    found = re.findall(r"^([a-z0-9-]+)==(\S+) \\\n    --hash=sha256:", text, re.MULTILINE)
    assert len(found) == len(re.findall(r"^[a-z0-9]", text, re.MULTILINE)) > 100
    return dict(found)


def test_the_locks_hold_every_requirement_with_its_version():
    run, everything = locked("run.txt"), locked("all.txt")
    assert run.items() <= everything.items()
    for path in REQUIREMENTS:
        for line in path.read_text().splitlines():
            if line.startswith(("#", "torch==")) or path.name == "apt.txt":
                continue
            name, version = re.sub(r"\[.*\]", "", line).split("==")
            name = re.sub(r"[-_.]+", "-", name).lower()
            assert everything[name] == version, f"make lock: {line}"
    assert "torch" not in everything, "it has several builds: it is pinned by its version alone"


def test_the_table_of_licences_is_that_of_the_locks():
    """And nothing that the node installs is under a licence that its users would have to take."""
    run, everything = locked("run.txt"), locked("all.txt")
    table = (ROOT / "docs" / "reference" / "licences.md").read_text()
    rows = re.findall(r"^\| ([a-z0-9-]+) \| (\S+) \| (.+) \| (run|all) \|$", table, re.MULTILINE)
    assert {name: version for name, version, _, _ in rows} == everything
    assert {name for name, _, _, installed in rows if installed == "run"} == run.keys()
    for name, _, licence, installed in rows:
        assert licence != "not stated", name
        if installed == "run" and name != "docutils":  # BSD or public domain but for one tool
            assert "GPL" not in licence, name
            assert "GNU" not in licence, name


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


def test_every_python_library_is_a_key_that_rosdep_can_find():
    """Each requirement of the core is in package.xml; those without a common key in rosdep.yaml."""
    manifest = ElementTree.parse(ROOT / "package.xml").getroot()
    declared = {one.text for one in manifest.iter("exec_depend")}
    shipped = yaml.safe_load((ROOT / "rosdep.yaml").read_text())
    packages = {
        package: key
        for key, rule in shipped.items()
        for package in rule["debian"]["pip"]["packages"]
    }
    common = {"opencv-python-headless": "python3-opencv", "pyyaml": "python3-yaml"}
    for line in (ROOT / "reflest_core" / "requirements.txt").read_text().splitlines():
        if line and not line.startswith("#"):
            name = line.split("==")[0]
            assert packages.get(name, common.get(name, f"python3-{name}")) in declared, name
    assert set(packages.values()) <= declared


def test_what_the_viewer_of_a_node_needs_is_a_key_too():
    """The launch file asks for the same packages, of the extra that pip installs."""
    manifest = ElementTree.parse(ROOT / "package.xml").getroot()
    declared = {one.text for one in manifest.iter("exec_depend")}
    shipped = yaml.safe_load((ROOT / "rosdep.yaml").read_text())
    extra = (ROOT / "reflest_core" / "requirements-viewer.txt").read_text()
    (needed,) = (
        ast.literal_eval(node.value)
        for node in ast.parse((ROOT / "launch" / "estimator.launch.py").read_text()).body
        if isinstance(node, ast.Assign) and node.targets[0].id == "VIEWER_PACKAGES"
    )
    assert set(needed) == {"viser", "trimesh"}
    for name in needed:
        assert f"reflest-{name}-pip" in declared
        for system in ("debian", "ubuntu"):
            assert shipped[f"reflest-{name}-pip"][system]["pip"]["packages"] == [name]
        assert f"\n{name}==" in extra


def test_every_ros_package_that_is_imported_is_declared():
    manifest = ElementTree.parse(ROOT / "package.xml").getroot()
    declared = {one.text for one in manifest.iter() if one.tag in ("depend", "exec_depend")}
    pattern = re.compile(
        r"^\s*(?:from|import) (\w+(?:_msgs|_interfaces|_ros|_python)|rclpy)\b", re.M
    )
    sources = [*(ROOT / "reflest_ros").rglob("*.py"), *(ROOT / "launch").glob("*.py")]
    imported = {name for path in sources for name in pattern.findall(path.read_text())}
    assert imported - {"reflest_ros"} <= declared


def test_a_script_without_its_libraries_says_so_in_one_sentence(tmp_path):
    for name in ("estimator", "bag_player", "reflest"):
        done = subprocess.run(
            [sys.executable, "-I", "-S", ROOT / "scripts" / name],
            cwd=tmp_path,
            env={},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 1
        assert len(done.stderr.splitlines()) == 1, done.stderr
        assert "is not installed" in done.stderr
