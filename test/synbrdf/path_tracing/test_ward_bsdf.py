# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Our Mitsuba plugin against the library's own Ward, and its sampling against its density."""

import numpy as np
import pytest

from reflest_core.brdf import ward
from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.brdf.sampling import specular_albedo

bsdf_module = pytest.importorskip("reflest_core.synbrdf.path_tracing.ward_bsdf")
mi = bsdf_module.mi

MATERIALS = [
    ((0.5, 0.2, 0.1), 0.3, 0.2),
    ((0.0, 0.1, 0.9), 0.1, 0.05),
    ((0.3, 0.3, 0.3), 0.6, 0.5),
    ((0.8, 0.7, 0.6), 0.0, 0.1),
    ((0.1, 0.1, 0.1), 0.2, 0.01),
]


def material(rho_d, rho_s, alpha, variant):
    return WardParameters(rho_d, rho_s, alpha, variant)


def interaction(wi):
    si = mi.SurfaceInteraction3f()
    si.wi = mi.Vector3f(*np.ascontiguousarray(wi.T, np.float32))
    return si


def random_directions(rng, count):
    """Half of them near the mirror direction of a fixed partner, so that lobes are met."""
    directions = rng.normal(size=(count, 3))
    directions[:, 2] = np.abs(directions[:, 2]) + 0.02
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def evaluate(bsdf, wi, wo):
    value = bsdf.eval(
        mi.BSDFContext(), interaction(wi), mi.Vector3f(*np.ascontiguousarray(wo.T, np.float32))
    )
    return np.array(value).T.reshape(-1, 3)


@pytest.mark.parametrize("variant", WardVariant)
@pytest.mark.parametrize("values", MATERIALS)
def test_equals_the_librarys_ward_times_cosine(values, variant):
    rng = np.random.default_rng(3)
    wi = random_directions(rng, 4000)
    mirrored = wi * [-1, -1, 1] + 0.5 * values[2] * rng.normal(size=wi.shape)
    mirrored[:, 2] = np.abs(mirrored[:, 2])
    mirrored /= np.linalg.norm(mirrored, axis=1, keepdims=True)
    wo = np.where(rng.uniform(size=(len(wi), 1)) < 0.5, mirrored, random_directions(rng, len(wi)))
    wi, wo = (d.astype(np.float32).astype(np.float64) for d in (wi, wo))
    plugin = bsdf_module.ward_bsdf(material(*values, variant))
    expected = wo[:, 2:] * ward.evaluate(np.array(values[0]), values[1], values[2], wi, wo, variant)
    tolerance = 2e-4 if values[2] > 0.02 else 2e-2  # single precision in a narrow exponential
    np.testing.assert_allclose(evaluate(plugin, wi, wo), expected, rtol=tolerance, atol=1e-5)


def test_is_black_across_the_surface_and_lit_on_both_sides():
    plugin = bsdf_module.ward_bsdf(WardParameters((0.5, 0.5, 0.5), 0.2, 0.2))
    up, down = np.array([[0.0, 0.6, 0.8]]), np.array([[0.0, 0.6, -0.8]])
    assert evaluate(plugin, up, down).max() == 0.0
    np.testing.assert_array_equal(evaluate(plugin, up, up), evaluate(plugin, down, down))
    assert evaluate(plugin, up, up).min() > 0.0


def test_takes_another_material_of_its_variant_only():
    plugin = bsdf_module.ward_bsdf(WardParameters((0.5, 0.5, 0.5), 0.2, 0.2))
    plugin.set_parameters(WardParameters((0.1, 0.2, 0.3), 0.0, 0.1))
    up = np.array([[0.0, 0.0, 1.0]])
    np.testing.assert_allclose(evaluate(plugin, up, up)[0], np.array([0.1, 0.2, 0.3]) / np.pi)
    with pytest.raises(ValueError, match="geisler"):
        plugin.set_parameters(WardParameters((0.1, 0.2, 0.3), 0.0, 0.1, WardVariant.BOUNDED_2010))


@pytest.mark.parametrize(
    ("rho_s", "alpha", "degrees", "variant"),
    [
        (0.3, 0.05, 0.0, WardVariant.WARD_1992),
        (0.3, 0.1, 45.0, WardVariant.WARD_1992),
        (0.6, 0.4, 70.0, WardVariant.WARD_1992),
        (0.3, 0.2, 30.0, WardVariant.BOUNDED_2010),
        (0.0, 0.2, 30.0, WardVariant.WARD_1992),
    ],
)
def test_samples_follow_the_density(rho_s, alpha, degrees, variant):
    angle = np.deg2rad(degrees)
    sample, density = mi.chi2.BSDFAdapter(
        "reflest_ward",
        {"type": "reflest_ward", "rho_s": rho_s, "alpha": alpha, "variant": variant.value},
        wi=[float(np.sin(angle)), 0.0, float(np.cos(angle))],
    )
    chi2 = mi.chi2.ChiSquareTest(
        domain=mi.chi2.SphericalDomain(),
        sample_func=sample,
        pdf_func=density,
        sample_dim=3,
        sample_count=400_000,
        ires=16,
    )
    assert chi2.run(test_count=5, quiet=True), chi2.messages


@pytest.mark.parametrize("variant", WardVariant)
@pytest.mark.parametrize("alpha", [0.05, 0.3])
@pytest.mark.parametrize("cosine", [1.0, 0.7, 0.3])
def test_white_furnace(alpha, cosine, variant):
    """Under light of 1 from everywhere the surface shows its albedo."""
    rho_d, rho_s = (0.6, 0.3, 0.0), 0.4
    plugin = bsdf_module.ward_bsdf(material(rho_d, rho_s, alpha, variant))
    rng = np.random.default_rng(0)
    count = 512
    u = ((np.arange(count) + 0.5) / count).astype(np.float32)
    grid = np.stack(np.meshgrid(u, u), axis=-1).reshape(-1, 2).astype(np.float32)
    first = rng.permutation(len(grid)).astype(np.float32) / len(grid)
    wi = np.array([[np.sqrt(1 - cosine**2), 0.0, cosine]]).repeat(len(grid), axis=0)
    _, weight = plugin.sample(
        mi.BSDFContext(), interaction(wi), mi.Float(first), mi.Point2f(*grid.T.copy())
    )
    albedo = np.array(weight).T.reshape(-1, 3).mean(axis=0)
    expected = np.array(rho_d) + specular_albedo(rho_s, alpha, np.array([cosine]), variant)
    np.testing.assert_allclose(albedo, expected, rtol=0.01, atol=0.002)
    if variant is WardVariant.BOUNDED_2010:
        assert albedo.max() <= 1.01
