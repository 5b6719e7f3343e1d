# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Imports run one way, and nothing in the core knows ROS."""

import ast
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CORE = ROOT / "reflest_core"
LEAVES = (
    "errors",
    "array_file",
    "parameter",
    "parameter_file",
    "jit",
    "ply_file",
    "whole_file",
    "provenance",
    "source_fingerprint",
)
STAGES = (
    "brdf",
    "light",
    "surface",
    "capture",
    "fusion",
    "inference",
    "segmentation",
    "models",
    "environment",
    "estimation",
    "rendering",
    "export",
    "viewer",
    "api",
    "synbrdf",
    "training",
    "evaluation",
    "cli",
)
"""A stage may import itself and what stands before it."""
LIVE = ("capture", "fusion", "inference", "segmentation", "models", "estimation")
HEAVY = ("torch", "mitsuba", "dask", "distributed", "matplotlib", "skimage")
ROS = ("rclpy", "sensor_msgs", "geometry_msgs", "std_msgs", "nav_msgs", "tf2_ros", "reflest_ros")


@cache
def modules():
    """Dotted name to file of every module of the core."""
    found = {}
    for path in sorted(CORE.rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


@cache
def imports(name, at_start=False):
    """Modules that a module imports, as (name, line); ``at_start``: while it is itself imported."""
    tree = ast.parse(modules()[name].read_text())
    skipped = set()
    for node in ast.walk(tree):
        is_for_types = isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
        is_later = at_start and isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        if is_for_types or is_later:
            skipped |= {id(inner) for inner in ast.walk(node)}
    found = []
    for node in ast.walk(tree):
        if id(node) in skipped:
            continue
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name}:{node.lineno} imports relatively"
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                found.append((full if full in modules() else node.module, node.lineno))
        elif isinstance(node, ast.Import):
            found += [(alias.name, node.lineno) for alias in node.names]
    return found


def stage_of(name):
    parts = name.split(".")
    return parts[1] if len(parts) > 1 else ""


def test_the_stages_are_all_there_are():
    folders = {path.name for path in CORE.iterdir() if (path / "__init__.py").is_file()}
    assert folders - set(STAGES) == set()
    files = {path.stem for path in CORE.glob("*.py")} - {"__init__", "setup"}
    assert files <= set(LEAVES)


@pytest.mark.parametrize("stage", STAGES)
def test_a_stage_imports_only_stages_before_it(stage):
    allowed = (*LEAVES, *STAGES[: STAGES.index(stage) + 1], "")
    back = [
        f"{name}:{line} imports {imported}"
        for name in modules()
        if stage_of(name) == stage
        for imported, line in imports(name)
        if imported.startswith("reflest_core") and stage_of(imported) not in allowed
    ]
    assert back == []


@pytest.mark.parametrize("leaf", LEAVES)
def test_a_leaf_imports_only_leaves(leaf):
    name = f"reflest_core.{leaf}"
    if name in modules():
        core = [imported for imported, _ in imports(name) if imported.startswith("reflest_core")]
        assert {stage_of(imported) for imported in core} <= {"", *LEAVES}


def test_no_two_modules_import_each_other():
    edges = defaultdict(set)
    for name in modules():
        for imported, _ in imports(name, at_start=True):
            if imported in modules() and imported != name:
                edges[name].add(imported)
    done, path = set(), []

    def visit(name):
        if name in path:
            raise AssertionError(" -> ".join([*path[path.index(name) :], name]))
        if name in done:
            return
        path.append(name)
        for imported in sorted(edges[name]):
            visit(imported)
        path.pop()
        done.add(name)

    for name in sorted(edges):
        visit(name)
    assert len(done) > 300


def test_the_core_knows_no_ros():
    known = [
        f"{name}:{line} imports {imported}"
        for name in modules()
        for imported, line in imports(name)
        if imported.split(".")[0] in ROS
    ]
    assert known == []


def test_the_live_path_loads_no_heavy_library_at_its_start():
    """PyTorch modules of the networks are loaded by training alone."""
    reached, waiting = set(), {"reflest_core.estimation.pipeline", "reflest_core.cli.replay"}
    while waiting:
        name = waiting.pop()
        reached.add(name)
        for imported, _ in imports(name, at_start=True):
            if imported in modules():
                waiting |= {imported} - reached
    heavy = [
        f"{name}:{line} imports {imported}"
        for name in sorted(reached)
        for imported, line in imports(name, at_start=True)
        if imported.split(".")[0] in HEAVY
    ]
    assert heavy == []
    assert len(reached) > 100
