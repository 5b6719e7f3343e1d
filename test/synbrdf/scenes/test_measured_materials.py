# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Materials that follow measurements: weakly glossy, often dark; and fits from a file."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reflest_core.brdf.lab import luminance
from reflest_core.synbrdf.scenes.material_sources import (
    Materials,
    MaterialSource,
    MaterialsRefused,
)
from reflest_core.synbrdf.scenes.measured_materials import (
    FAMILIES,
    MaterialFitsUnreadable,
    draw_measured,
    read_fits,
)

HEADER = "source,material,rho_d_r,rho_d_g,rho_d_b,rho_s_r,rho_s_g,rho_s_b,alpha,rmse\n"


def draws(count):
    return [draw_measured(np.random.default_rng(seed)) for seed in range(count)]


@given(st.integers(0, 2**32))
def test_every_draw_is_a_material_of_its_family(seed):
    ward, name = draw_measured(np.random.default_rng(seed))
    family = FAMILIES[name]
    assert min(ward.rho_d) > 0 or family.saturation[1] == 1
    assert max(ward.rho_d) + ward.rho_s <= 1 + 1e-9
    assert family.alpha[0] <= ward.alpha <= family.alpha[1]
    assert max(ward.rho_d) <= family.albedo[1] * (1 + 1e-9)
    assert ward.rho_s <= family.rho_s[1] * (1 + 1e-9)


def test_the_families_cover_what_opensurfaces_space_hardly_holds():
    wards = [ward for ward, _ in draws(2000)]
    rho_s, alpha = (
        np.array([getattr(ward, name) for ward in wards]) for name in ("rho_s", "alpha")
    )
    brightest = np.array([max(ward.rho_d) for ward in wards])
    # Ngan et al.'s fits of the MERL materials: median rho_s .034, alpha .01 to .25.
    assert 0.02 < np.median(rho_s) < 0.045
    sharp = (rho_s < 0.05) & (alpha < 0.08)
    assert 0.25 < sharp.mean() < 0.6
    assert 0.1 < (brightest < 0.03).mean() < 0.35
    assert alpha.max() > 0.3
    assert sum(family.share for family in FAMILIES.values()) == pytest.approx(1.0)
    drawn = [name for _, name in draws(2000)]
    for name, family in FAMILIES.items():
        assert drawn.count(name) / 2000 == pytest.approx(family.share, abs=0.03)


def test_a_fit_keeps_its_values_and_its_lobe_takes_the_luminance(tmp_path):
    table = tmp_path / "fits.csv"
    table.write_text(HEADER + "lab,red,.5,.1,.05,.02,.04,.06,.02,0\nlab,felt,.1,.1,.1,1,1,1,.7,0\n")
    assert list(read_fits(table)) == ["red"]
    red = read_fits(table)["red"]
    assert red.rho_d == (0.5, 0.1, 0.05)
    assert red.rho_s == pytest.approx(float(luminance(np.array([0.02, 0.04, 0.06]))))
    assert red.alpha == 0.02


def test_a_fit_of_too_much_energy_is_scaled_down(tmp_path):
    table = tmp_path / "fits.csv"
    table.write_text(HEADER + "lab,gold,.5,.25,0,1.5,1.5,1.5,.1,0\n")
    gold = read_fits(table)["gold"]
    assert gold.rho_d[0] + gold.rho_s == pytest.approx(1.0)
    assert gold.rho_d == pytest.approx((0.25, 0.125, 0.0))


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("a,b\n1,2\n", "no material, rho_d_r"),
        (HEADER + "lab,x,.5,.1,.1,.1,.1,.1,much,0\n", "line 2"),
        (HEADER + "lab,x,.5,.1,.1,.1,.1,.1,nan,0\n", "finite"),
        (HEADER + "lab,x,-.5,.1,.1,.1,.1,.1,.1,0\n", "0 or more"),
        (HEADER, "no fit"),
    ],
)
def test_a_bad_table_is_refused_in_words(tmp_path, text, reason):
    table = tmp_path / "fits.csv"
    table.write_text(text)
    with pytest.raises(MaterialFitsUnreadable, match=reason):
        read_fits(table)


def test_a_missing_table_and_fits_without_their_source_are_refused(tmp_path):
    with pytest.raises(MaterialFitsUnreadable, match=r"nowhere\.csv cannot be read"):
        read_fits(tmp_path / "nowhere.csv")
    with pytest.raises(MaterialsRefused, match="--materials measured"):
        Materials(MaterialSource.OPENSURFACES, tmp_path / "fits.csv")


def test_each_source_names_what_it_drew(tmp_path):
    table = tmp_path / "fits.csv"
    table.write_text(HEADER + "lab,red,.5,.1,.05,.02,.04,.06,.02,0\n")
    fitted = Materials(MaterialSource.MEASURED, table).draw(np.random.default_rng(1))
    assert (fitted.source, fitted.name) == (MaterialSource.MEASURED, "red")
    family = Materials(MaterialSource.MEASURED).draw(np.random.default_rng(1))
    assert family.name in FAMILIES
    assert Materials().draw(np.random.default_rng(1)).name == "opensurfaces"
