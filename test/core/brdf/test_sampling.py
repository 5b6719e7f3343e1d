# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The lobe's sampler against its density and the BRDF."""

import math

import numpy as np
import pytest
from scipy.stats import chisquare

from reflest_core.brdf.parameters import WardVariant
from reflest_core.brdf.sampling import sample_specular, specular_weight
from reflest_core.brdf.ward import specular

OMEGA_O = np.array([math.sin(0.7), 0.0, math.cos(0.7)])


def specular_density(alpha, omega_i, omega_o):
    """Density (...) of sampled directions per steradian of ``omega_i``.

    The half vector carries Ward's Gaussian of tan theta_h; the mirror map has Jacobian 1/(4 h.o).
    """
    half = omega_i + omega_o
    length = np.linalg.norm(half, axis=-1)
    cos_h = half[..., 2] / length
    tan_squared = 1 / cos_h**2 - 1
    density_h = np.exp(-tan_squared / alpha**2) / (math.pi * alpha**2 * cos_h**3)
    return np.where(cos_h > 0, density_h / (2 * length), 0.0)


def sphere_grid(rows, columns):
    """Unit directions (rows * columns, 3) at cell centres of equal solid angle, and that angle."""
    z = 1 - 2 * (np.arange(rows) + 0.5) / rows
    phi = 2 * math.pi * (np.arange(columns) + 0.5) / columns
    z, phi = (axis.reshape(-1) for axis in np.meshgrid(z, phi, indexing="ij"))
    r = np.sqrt(1 - z**2)
    directions = np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1)
    return directions, 4 * math.pi / (rows * columns)


def cell_of(directions, rows, columns):
    row = np.minimum(((1 - directions[:, 2]) / 2 * rows).astype(int), rows - 1)
    turn = np.arctan2(directions[:, 1], directions[:, 0]) / (2 * math.pi)
    return row * columns + np.minimum((turn % 1.0 * columns).astype(int), columns - 1)


@pytest.mark.parametrize("alpha", [0.2, 0.5])
def test_chi_square_of_samples_against_density(alpha):
    rows, columns, fine, count = 16, 16, 16, 200_000
    u = np.random.default_rng(7).random((count, 2))
    observed = np.bincount(
        cell_of(sample_specular(alpha, OMEGA_O, u), rows, columns), minlength=rows * columns
    )
    directions, solid_angle = sphere_grid(rows * fine, columns * fine)
    density = specular_density(alpha, directions, OMEGA_O) * solid_angle
    expected = count * density.reshape(rows, fine, columns, fine).sum(axis=(1, 3)).reshape(-1)
    many = expected > 10
    observed = np.append(observed[many], observed[~many].sum())
    expected = np.append(expected[many], max(count - expected[many].sum(), 1e-9))
    kept = expected > 5
    scale = observed[kept].sum() / expected[kept].sum()
    assert chisquare(observed[kept], expected[kept] * scale).pvalue > 0.01
    assert scale == pytest.approx(1, abs=5e-3)


@pytest.mark.parametrize("variant", list(WardVariant))
def test_weight_is_brdf_times_cosine_over_density(variant):
    u = np.random.default_rng(3).random((500, 2))
    omega_i = sample_specular(0.3, OMEGA_O, u)
    omega_i = omega_i[omega_i[:, 2] > 1e-3]
    value = specular(np.array(0.4), np.array(0.3), omega_i, OMEGA_O, variant)
    expected = value * omega_i[:, 2] / specular_density(0.3, omega_i, OMEGA_O)
    weight = specular_weight(np.array(0.4), omega_i, OMEGA_O, variant)
    np.testing.assert_allclose(weight, expected, rtol=1e-9)
