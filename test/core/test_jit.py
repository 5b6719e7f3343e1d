# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Kernels are compiled also where little can be written, and never in silence."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numba
import pytest

from reflest_core import jit

CAPTURE = Path(__file__).parents[2] / "captures" / "glossy-red"


@pytest.fixture
def config(monkeypatch, tmp_path):
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.delenv(jit.CACHE_VARIABLE, raising=False)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return numba.config


def test_nothing_changes_where_kernels_can_be_kept(config):
    jit.cache_where_possible()
    assert config.CACHE_DIR == ""


def test_a_folder_of_ones_own_is_used_where_nothing_else_can_be_written(
    config, monkeypatch, tmp_path
):
    monkeypatch.setattr(os, "access", lambda *_: False)
    jit.cache_where_possible()
    own = Path(config.CACHE_DIR)
    assert own.parent == tmp_path
    assert own.stat().st_mode & 0o777 == 0o700


def test_a_folder_that_others_can_write_is_not_trusted(config, monkeypatch, tmp_path):
    monkeypatch.setattr(os, "access", lambda *_: False)
    (tmp_path / f"reflest-kernels-{os.getuid()}").mkdir()
    (tmp_path / f"reflest-kernels-{os.getuid()}").chmod(0o777)
    jit.cache_where_possible()
    assert Path(config.CACHE_DIR).stat().st_mode & 0o777 == 0o700


def test_a_kernel_compiles_there(tmp_path):
    """A copy of the module in a read-only folder, with a home that does not exist."""
    code = (
        "import os; os.access = lambda *_: False\n"
        "from reflest_core.surface.voxel_key import pack_key\n"
        "print(pack_key(1, 2, 3))"
    )
    environment = {**os.environ, "TMPDIR": str(tmp_path), "HOME": "/nonexistent"}
    environment.pop(jit.CACHE_VARIABLE, None)
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True
    )
    assert int(done.stdout) > 0
    assert list(tmp_path.glob("reflest-kernels-*/**/*.nbi"))


KERNEL = """
from reflest_core.jit import announce_compilation, compiled

@compiled
def one(x):
    return x + 1

@compiled
def two(x):
    return x + 2

announce_compilation()
announce_compilation()
one(1), two(1)
"""


def test_a_compilation_is_said_once_and_kernels_from_the_cache_are_not(tmp_path):
    script = tmp_path / "kernels.py"
    script.write_text(KERNEL)
    environment = {**os.environ, jit.CACHE_VARIABLE: str(tmp_path / "cache")}

    def said():
        command = [sys.executable, str(script)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        return done.stderr.splitlines()

    assert said() == [f"reflest: {jit.FIRST_RUN}"]
    assert said() == []


SCANNER = """
import numpy as np
from reflest_core import Scanner
scanner = Scanner()
scanner.add(
    np.zeros((48, 64, 3), np.uint8), np.ones((48, 64)), (60.0, 60.0, 31.5, 23.5), np.eye(4)
)
"""


@pytest.mark.parametrize(
    "words",
    [
        ["-m", "reflest_core.cli.main", "replay", str(CAPTURE)],
        ["-m", "reflest_core.cli.main", "view", str(CAPTURE), "--port", "0"],
        [
            "-m",
            "reflest_core.cli.main",
            "export",
            str(CAPTURE),
            "--format",
            "hdr",
            "--out",
            "a.hdr",
        ],
        ["-c", SCANNER],
    ],
    ids=["replay", "view", "export", "scanner"],
)
def test_the_first_run_says_that_it_compiles(words, tmp_path):
    environment = {
        **os.environ,
        jit.CACHE_VARIABLE: str(tmp_path),
        "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
    }
    started = subprocess.Popen(
        [sys.executable, *words],
        env=environment,
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert any(jit.FIRST_RUN in line for line in started.stderr)
    finally:
        started.kill()
        started.communicate()
