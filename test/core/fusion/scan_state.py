# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Everything a scan holds, to compare bit for bit."""

from __future__ import annotations

import dataclasses

import numpy as np

from reflest_core.fusion.tsdf.tsdf_blocks import surface_keys


def state_of(scan):
    arrays = {
        f"{type(stage).__name__}.{name}": array[: stage.count].copy()
        for stage in (scan.volume, scan.store, scan.views)
        for name, array in stage.arrays.items()
        if name != "first_chunks"  # where observations lie may differ; what they are may not
    }
    arrays["colours"], arrays["view_ids"] = scan.store.observations(np.arange(scan.store.count))
    arrays |= {f"light.{name}": array.copy() for name, array in scan.light.arrays.items()}
    arrays["numbers"] = np.array([scan.frame_number, scan.last_stamp_ns or -1])
    return arrays


def assert_same_arrays(one, other):
    assert one.keys() == other.keys()
    for name in one:
        np.testing.assert_array_equal(one[name], other[name], err_msg=name, strict=True)


def assert_same_surface(one, other):
    one, other = dataclasses.asdict(one), dataclasses.asdict(other)
    assert_same_arrays(one.pop("light"), other.pop("light"))
    assert_same_arrays(one, other)


def assert_no_ghosts(scan):
    """Every stored voxel is a surface voxel of the volume as it is now."""
    surface = surface_keys(np.arange(scan.volume.count), scan.volume.blocks)
    assert np.isin(scan.store.rows.keys[: scan.store.count], surface).all()
