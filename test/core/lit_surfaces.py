# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light for the surfaces of tests: an even sky, of which a part is seen and a part overexposed."""

import dataclasses

import numpy as np

from reflest_core.light.light_map import LightMap


def lit(surface, seen=1.0, lamp=False, seed=0):
    """The surface under a grey sky that shows down from the zenith to a ``seen`` share of heights.

    ``lamp``: everything above 30 degrees of elevation is overexposed.
    """
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(60_000, 3)).astype(np.float32)
    height = directions[:, 2] / np.linalg.norm(directions, axis=1)
    colours = np.where(lamp & (height > 0.5), 255, 120)[:, None] * np.ones(3)
    shown = height > 1.0 - 2.0 * seen
    light = LightMap()
    light.add(directions[shown], colours[shown].astype(np.uint8))
    return dataclasses.replace(surface, light=light.observed())
