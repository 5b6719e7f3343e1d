# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A rougher surface blurs what it reflects, and that shows without knowing what it reflects."""

import dataclasses

import numpy as np

from reflest_core.brdf import srgb
from reflest_core.inference.transport.reflected_detail import CELLS, LEAST, reflected_detail
from reflest_core.light.light_map import SIZE
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.surface.observed_surface import ObservedSurface
from test.core.inference.glossy_ball import ball

FAR = 1e4


def chequered():
    """Bright and dark squares about 20 degrees wide."""
    z = octahedral_directions(SIZE)
    around = np.arctan2(z[..., 1], z[..., 0])
    squares = np.sin(9.0 * around) * np.sin(9.0 * np.arccos(z[..., 2])) > 0.0
    return np.repeat(np.where(squares, 0.9, 0.05)[..., None], 3, axis=2).astype(np.float32)


def surface_of(roughness, rho_s=0.5):
    """The ball, with a view for each observation, from far away."""
    sample = ball(chequered(), (0.1, 0.1, 0.1), rho_s, roughness, voxels=1000)
    counts = np.bincount(sample.voxel_of)
    views = np.full((len(sample.voxel_of), 3), 128.0, np.float32)
    return ObservedSurface(
        np.zeros_like(sample.normals),
        sample.normals,
        np.concatenate([[0], np.cumsum(counts)]),
        np.rint(255.0 * srgb.encode(sample.colours)).astype(np.uint8),
        np.arange(len(views), dtype=np.uint16),
        (FAR * sample.directions).astype(np.float32),
        views,
        views,
    )


def detail(surface):
    return reflected_detail(surface, np.arange(surface.voxel_count))


def test_rough_surfaces_vary_less_and_as_much_within_small_cells():
    polished, satin, rough = (detail(surface_of(roughness)) for roughness in (0, 3, 7))
    assert polished[-1] > satin[-1] + 0.2 > rough[-1] + 0.3
    fall_from_17_to_4_degrees = [d[1] - d[3] for d in (polished, satin, rough)]
    assert (np.diff(fall_from_17_to_4_degrees) < -0.1).all()


def test_brightness_hardly_matters():
    surface = surface_of(2)
    linear = srgb.LINEAR[surface.colours]
    dimmer = np.rint(255.0 * srgb.encode(0.5 * linear)).astype(np.uint8)
    half = dataclasses.replace(surface, colours=dimmer)
    np.testing.assert_allclose(detail(surface), detail(half), atol=0.1)


def test_noise_alone_is_as_strong_within_every_cell():
    surface = surface_of(2)
    noise = np.random.default_rng(1).integers(60, 190, len(surface.colours))
    noisy = dataclasses.replace(
        surface, colours=np.repeat(noise[:, None], 3, axis=1).astype(np.uint8)
    )
    shares = np.exp(detail(noisy)[: len(CELLS)]) - LEAST
    np.testing.assert_allclose(shares[:3], 1.0, atol=0.2)
