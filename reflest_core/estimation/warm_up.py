# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Compiles capture, fusion and estimation before the first real frame has to wait for it.

``python -m reflest_core.estimation.warm_up`` does so after an installation.
"""

from __future__ import annotations

import numpy as np

from reflest_core.capture import warm_up as capture
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.fusion import warm_up as fusion
from reflest_core.light.light_map import LightMap
from reflest_core.models.registry import shipped_models
from reflest_core.surface.observed_surface import ObservedSurface

SIDE, VIEWS = 32, 6
"""32 x 32 voxels are more than any network chooses or ``min_voxels`` can ask for."""


def warm_up(estimator: Estimator) -> None:
    """Run every kernel once: a second, or about a minute on the first start.

    Args:
        estimator: with the network that will be used.
    """
    capture.warm_up()
    fusion.warm_up()
    estimator.estimate(_grey_wall(), 0, "")


def _grey_wall() -> ObservedSurface:
    """A square wall at z = 0, every voxel seen from every view, light from in front of it."""
    light = LightMap()
    light.add(np.array([[0.0, 0.0, 1.0]], np.float32), np.full((1, 3), 128, np.uint8))
    voxels = SIDE**2
    across = np.arange(voxels) % SIDE * 0.01
    up = np.arange(voxels) // SIDE * 0.01
    return ObservedSurface(
        positions=np.stack([across, up, np.zeros(voxels)], axis=1).astype(np.float32),
        normals=np.tile(np.array([0.0, 0.0, 1.0], np.float32), (voxels, 1)),
        offsets=np.arange(voxels + 1, dtype=np.int64) * VIEWS,
        colours=np.full((voxels * VIEWS, 3), 128, np.uint8),
        view_indices=np.tile(np.arange(VIEWS, dtype=np.uint16), voxels),
        view_centres=np.array([[0.1 * view, 0.0, 0.5] for view in range(VIEWS)], np.float32),
        view_foreground=np.full((VIEWS, 3), 128.0, np.float32),
        view_background=np.full((VIEWS, 3), np.nan, np.float32),
        light=light.observed(),
    )


if __name__ == "__main__":
    for model in shipped_models():
        warm_up(Estimator(EstimationSettings(model=model)))
