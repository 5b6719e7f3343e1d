# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A rougher surface blurs what it reflects, and that shows without knowing what it reflects."""

import dataclasses

import numpy as np

from reflest_core.features.light.reflected_detail import CELLS, LEAST, reflected_detail
from reflest_core.fusion.light_map import SIZE
from reflest_core.fusion.octahedral import octahedral_directions
from test.core.features.light.glossy_ball import ball


def chequered():
    """Bright and dark squares about 20 degrees wide."""
    z = octahedral_directions(SIZE)
    around = np.arctan2(z[..., 1], z[..., 0])
    squares = np.sin(9.0 * around) * np.sin(9.0 * np.arccos(z[..., 2])) > 0.0
    return np.repeat(np.where(squares, 0.9, 0.05)[..., None], 3, axis=2).astype(np.float32)


def test_rough_surfaces_vary_less_within_small_cells():
    polished, satin, rough = (
        reflected_detail(ball(chequered(), (0.1, 0.1, 0.1), 0.5, roughness))
        for roughness in (0, 3, 7)
    )
    assert polished[-1] > satin[-1] > rough[-1]
    relative = [d[2] + d[-1] for d in (polished, satin, rough)]
    assert relative[0] > relative[1] + 0.1 > relative[2]


def test_brightness_does_not_matter():
    sample = ball(chequered(), (0.1, 0.1, 0.1), 0.3, 2)
    dimmer = dataclasses.replace(sample, colours=0.25 * sample.colours)
    np.testing.assert_allclose(reflected_detail(sample), reflected_detail(dimmer), atol=1e-4)


def test_noise_alone_is_as_strong_within_every_cell():
    sample = ball(chequered(), (0.1, 0.1, 0.1), 0.0, 2)
    noise = np.random.default_rng(1).normal(0.5, 0.1, len(sample.colours)).astype(np.float32)
    noisy = dataclasses.replace(sample, colours=np.repeat(noise[:, None], 3, axis=1))
    shares = np.exp(reflected_detail(noisy)[: len(CELLS)]) - LEAST
    np.testing.assert_allclose(shares[:3], 1.0, atol=0.25)
