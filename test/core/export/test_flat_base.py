# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import tracemalloc

import numpy as np

from reflest_core.export.flat_base import base_below


def test_things_far_apart_take_little_memory():
    """A grid of columns as fine as the voxels would take more than a gigabyte."""
    plate = np.stack(np.meshgrid(np.arange(40), np.arange(40), [0]), axis=-1).reshape(-1, 3)
    plate = plate.astype(np.float32) * np.float32(0.005)
    positions = np.concatenate([plate, plate + np.float32([60.0, 60.0, 0.0])])
    normals = np.tile(np.float32([0.0, 0.0, 1.0]), (len(positions), 1))
    tracemalloc.start()
    base = base_below(positions, normals, 0.005, (0.0, 0.0, 1.0))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 2**28
    is_far = base.positions[:, 0] > 30.0
    assert is_far.any()
    assert not is_far.all()
