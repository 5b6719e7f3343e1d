# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""After warming up no estimate waits for a compiler, whichever network and scan it is of."""

import dataclasses
import importlib
import pkgutil
import subprocess
import sys

import numpy as np
import pytest
from numba.core.registry import CPUDispatcher

import reflest_core.inference
import reflest_core.light
import reflest_core.models
import reflest_core.segmentation
import reflest_core.surface
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.scan_memory import ScanMemory
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.estimation.warm_up import warm_up
from reflest_core.models.registry import models
from test.core.lit_surfaces import lit
from test.core.lit_table import lit_table
from test.core.surfaces import sphere_surface
from test.core.weight_files import untrained_lightnet

SCRIPT = """
from reflest_core.capture.images import decode
from reflest_core.capture.settings import CaptureSettings
from reflest_core.estimation.warm_up import _warm_up_capture
_warm_up_capture()
before = decode._metres_by_unit.cache_info()
decode._metres_by_unit(CaptureSettings().depth_unit(), False)
after = decode._metres_by_unit.cache_info()
assert (after.misses, after.hits) == (before.misses, before.hits + 1)
"""


def compiled_versions():
    """How many compiled versions there are of each kernel between fusion and estimate."""
    versions = {}
    packages = (
        reflest_core.light,
        reflest_core.surface,
        reflest_core.inference,
        reflest_core.segmentation,
        reflest_core.models,
    )
    for package in packages:
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            content = vars(importlib.import_module(module.name))
            for name, value in content.items():
                if isinstance(value, CPUDispatcher):
                    versions[f"{module.name}.{name}"] = len(value.signatures)
    return versions


@pytest.mark.parametrize("model", models())
def test_no_kernel_is_compiled_afterwards(model, tmp_path):
    weights = str(untrained_lightnet(tmp_path)) if model == "lightnet" else ""
    estimator = Estimator(EstimationSettings(model=model, weights=weights, up=(0.0, -1.0, 0.0)))
    table = lit_table().surface  # which calls a kernel itself
    warm_up(estimator)
    before = compiled_versions()
    surface = lit(sphere_surface(voxels=1000))
    unknown = dataclasses.replace(
        surface, view_background=np.full((40, 3), np.nan, np.float32), light=None
    )
    for scan in (surface, unknown):
        estimator.estimate(scan, 0, "")
    estimator.segmented_materials(table, ScanMemory(), 0, "")
    assert compiled_versions() == before
    assert before["reflest_core.surface.voxel_choice._k_centre_clusters"] == 1
    assert before["reflest_core.light.turned_light._turn"] == 1


def test_the_table_of_metres_is_filled():
    """In a process of its own, where no other test has filled it."""
    subprocess.run([sys.executable, "-c", SCRIPT], check=True)
