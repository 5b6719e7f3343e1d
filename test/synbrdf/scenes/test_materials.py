# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.synbrdf.scenes.materials import OpenSurfacesLabel, draw_material, to_ward


def test_opensurfaces_formulas_by_hand():
    # v = 0.5, so rho_d = colour * v^2; luminance 0.2126 * 0.125 + 0.7152 * 0.0625 = 0.071275;
    # rho_s = (0.3 + cbrt(0.0356375))^3 - 0.0356375.
    ward = to_ward(OpenSurfacesLabel((0.5, 0.25, 0.0), contrast=0.3, doi=6.0))
    assert ward.rho_d == pytest.approx((0.125, 0.0625, 0.0))
    assert ward.alpha == pytest.approx(0.001 + 9 * 0.2 / 15)
    assert ward.rho_s == pytest.approx((0.3 + 0.0356375 ** (1 / 3)) ** 3 - 0.0356375, rel=1e-3)


def test_the_ends_of_doi():
    assert to_ward(OpenSurfacesLabel((0.5, 0.5, 0.5), 0.1, 15.0)).alpha == pytest.approx(0.001)
    assert to_ward(OpenSurfacesLabel((0.5, 0.5, 0.5), 0.1, 0.0)).alpha == pytest.approx(0.201)


def test_too_much_energy_is_divided_away():
    ward = to_ward(OpenSurfacesLabel((1.0, 0.5, 0.0), contrast=1.0, doi=10.0))
    assert max(ward.rho_d) + ward.rho_s == pytest.approx(1.0)
    assert ward.rho_d[1] == pytest.approx(0.5 * ward.rho_d[0])


@given(st.integers(0, 2**32))
def test_every_material_is_in_the_gamut(seed):
    ward = draw_material(np.random.default_rng(seed))
    assert min(ward.rho_d) >= 0
    assert ward.rho_s >= 0
    assert max(ward.rho_d) + ward.rho_s <= 1 + 1e-9
    assert 0.001 <= ward.alpha <= 0.201 + 1e-9


def test_the_draw_covers_the_space():
    materials = [draw_material(np.random.default_rng(seed)) for seed in range(600)]
    brightest = np.array([max(material.rho_d) for material in materials])
    rho_s = np.array([material.rho_s for material in materials])
    alpha = np.array([material.alpha for material in materials])
    assert brightest.min() < 0.05 < 0.6 < brightest.max()
    assert np.quantile(rho_s, 0.1) < 0.03 < 0.3 < np.quantile(rho_s, 0.95)
    assert alpha.min() < 0.01 < 0.19 < alpha.max()
