# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``memory_budget_mb`` bounds what the process holds; a full scan still takes in what it sees."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from reflest_core.fusion.memory_budget import WORKING_MB

BUDGET_MB = 32.0


@pytest.fixture(scope="module")
def corridor():
    script = Path(__file__).with_name("resident_scan.py")
    root = script.parents[3]
    done = subprocess.run(
        [sys.executable, str(script), str(BUDGET_MB)],
        capture_output=True,
        text=True,
        cwd=root,
        env={"PYTHONPATH": str(root)},
        check=True,
    )
    return json.loads(done.stdout)


def test_the_scan_went_far_beyond_its_budget(corridor):
    assert corridor["frames"] * 0.15 / 0.005 * 1.2 / 0.005 > 10 * corridor["voxel_capacity"]


def test_resident_memory_stays_within_the_budget_and_a_stated_constant(corridor):
    assert 0.5 * BUDGET_MB * 1e6 < corridor["grown"] < (BUDGET_MB + WORKING_MB) * 1e6
    assert corridor["reserved"] <= BUDGET_MB * 1e6


def test_what_is_seen_is_still_stored(corridor):
    assert corridor["least_stored"] == 1.0
    assert corridor["voxels"] > 0.8 * corridor["voxel_capacity"]
    assert corridor["observations"] > 5 * corridor["voxels"]
