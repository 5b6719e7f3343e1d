# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""After warming up no frame waits for a compiler, whatever its arrays look like."""

import dataclasses
import importlib
import pkgutil
import subprocess
import sys
from pathlib import Path

import numpy as np
from numba.core.registry import CPUDispatcher

import reflest_core.fusion
from reflest_core.fusion.observations.views import ViewTable
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.warm_up import warm_up
from test.core.fusion.analytic_scene import OBJECT, look_at, orbit_frames, render
from test.core.fusion.scan_state import assert_same_arrays, state_of


def compiled_versions():
    """How many compiled versions there are of each kernel, over all modules of fusion."""
    versions = {}
    for module in pkgutil.walk_packages(reflest_core.fusion.__path__, "reflest_core.fusion."):
        content = vars(importlib.import_module(module.name))
        for name, value in content.items():
            if isinstance(value, CPUDispatcher) and value.__module__ == module.name:
                versions[f"{module.name}.{name}"] = len(value.signatures)
    return versions


def awkward(frame):
    """The same frame as it comes off the wire: read-only, strided, single precision."""
    rgb = np.frombuffer(frame.rgb[..., ::-1].tobytes(), np.uint8).reshape(frame.rgb.shape)
    depth = np.asfortranarray(frame.depth)
    mask = frame.depth > 0.0
    for array in (depth, mask):
        array.flags.writeable = False
    return dataclasses.replace(
        frame,
        rgb=rgb[..., ::-1],
        depth=depth,
        T_world_camera=np.asfortranarray(frame.T_world_camera),
        mask=mask,
    )


def test_no_kernel_is_compiled_afterwards():
    warm_up()
    before = compiled_versions()
    assert len(before) > 20
    scan = Scan(
        FusionSettings(max_depth=1.0, memory_budget_mb=16.0, observations_per_voxel=255),
        RegionSettings(),
    )
    scan.views = ViewTable(4)
    redundant = 0
    for frame in orbit_frames(6):
        for n in range(scan.fusion.frames_per_view + 2):
            again = dataclasses.replace(awkward(frame), stamp_ns=100 * frame.stamp_ns + n)
            redundant += scan.fuse(again).is_redundant
    assert redundant > 0
    for n in range(1, 9):
        place = (0.4 * n, 0.0, 0.0)
        sphere = dataclasses.replace(OBJECT, centre=place)
        camera = look_at((place[0], -0.4, 0.1), place)
        frame = render([sphere], camera, n + 10)
        scan.fuse(dataclasses.replace(frame, stamp_ns=scan.last_stamp_ns + 1))
    scan.snapshot()
    grown = {k: v for k, v in compiled_versions().items() if v > before[k]}
    assert not grown


def test_nor_in_a_process_in_which_no_other_test_ran_a_kernel():
    test = f"{__file__}::{test_no_kernel_is_compiled_afterwards.__name__}"
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", test],
        cwd=Path(__file__).parents[3],
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stdout


def test_layout_of_the_arrays_does_not_matter():
    plain, wire = (Scan(FusionSettings(max_depth=1.0), RegionSettings()) for _ in range(2))
    for frame in orbit_frames(3):
        plain.fuse(dataclasses.replace(frame, mask=frame.depth > 0.0))
        wire.fuse(awkward(frame))
    assert_same_arrays(state_of(plain), state_of(wire))
