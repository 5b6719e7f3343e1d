# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings

from reflest_core.fusion.memory_budget import MemoryBudgetError
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.fusion.analytic_scene import OBJECT, look_at, render
from test.core.fusion.scan_state import assert_no_ghosts


@hypothesis_settings(max_examples=20)
@given(st.floats(16.0, 400.0), st.integers(5, 255))
def test_reserved_bytes_use_the_budget_and_never_pass_it(budget_mb, observations_per_voxel):
    settings = FusionSettings(
        memory_budget_mb=budget_mb, observations_per_voxel=observations_per_voxel
    )
    scan = Scan(settings, RegionSettings())
    assert 0.8 * budget_mb * 1e6 < scan.nbytes <= budget_mb * 1e6
    assert scan.volume.capacity >= 300


def test_long_scan_in_a_small_budget_forgets_the_oldest_surface():
    settings = FusionSettings(
        voxel_size=0.003,
        max_depth=1.0,
        memory_budget_mb=16.0,
        observations_per_voxel=255,
        work_radius=10.0,
    )
    scan = Scan(settings, RegionSettings())
    reserved = scan.nbytes
    places = np.linspace(0.0, 4.0, 21)
    for n, x in enumerate(places):
        sphere = type(OBJECT)((x, 0.0, 0.0), 0.1)
        scan.fuse(render([sphere], look_at((x, -0.4, 0.1), (x, 0.0, 0.0)), n))
        assert scan.nbytes == reserved
        assert scan.volume.count <= scan.volume.capacity
        assert scan.store.count <= scan.store.capacity
        assert_no_ghosts(scan)
    x = scan.snapshot().positions[:, 0]
    assert x.max() > 3.9
    assert x.min() > 1.0
    keys = scan.store.rows.keys[: scan.store.count]
    assert len(np.unique(keys)) == len(keys)


def test_budget_beyond_the_machine_is_one_sentence(monkeypatch):
    def refuse(*_args, **_kwargs):
        raise MemoryError

    monkeypatch.setattr("reflest_core.fusion.scan_state.TsdfVolume", refuse)
    with pytest.raises(MemoryBudgetError, match="memory_budget_mb = 256 MB"):
        Scan(FusionSettings(), RegionSettings())
