# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Kernels are compiled also where neither the sources nor the home can be written."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numba
import pytest

from reflest_core import jit


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
