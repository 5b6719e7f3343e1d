# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The exported material looks like Ward's: pictures of spheres, compared by FLIP.

Mitsuba renders the microfacet model that glTF defines, with the values of the file, and three.js
renders the file itself in headless Chromium; both against reflest's own Ward renderer.
"""

import dataclasses
import json

import numpy as np
import pytest

from reflest_core.brdf.parameters import WardVariant
from reflest_core.evaluation.pictures.image_distance import image_distance
from reflest_core.export.exporter import export_estimate
from reflest_core.rendering.environments import studio
from reflest_core.rendering.sphere import render_environment, render_point_light, tone_map
from reflest_core.synbrdf.path_tracing.ward_bsdf import mi
from test.core.export.estimates import glossy_red
from test.web.browser import shown

SIZE = 128
LIGHT = np.array([0.5, -0.8, 0.6]) / np.linalg.norm([0.5, -0.8, 0.6])
MATERIALS = {
    "satin": glossy_red(rho_d=(0.2, 0.2, 0.25), rho_s=0.05, alpha=0.2),
    "polished": glossy_red(rho_d=(0.5, 0.4, 0.3), rho_s=0.03, alpha=0.04),
    "plastic": glossy_red(rho_d=(0.1, 0.3, 0.15), rho_s=0.06, alpha=0.1),
    "dark and glossy": glossy_red(rho_d=(0.03, 0.03, 0.03), rho_s=0.1, alpha=0.1),
    "glossy red": glossy_red(),
}
MOST = 0.05
MORE = {
    ("lamp", "dark and glossy", WardVariant.BOUNDED_2010): 0.058,
    ("lamp", "glossy red", WardVariant.BOUNDED_2010): 0.062,
    ("studio", "plastic", WardVariant.WARD_1992): 0.054,
    ("studio", "dark and glossy", WardVariant.WARD_1992): 0.081,
    ("studio", "glossy red", WardVariant.WARD_1992): 0.089,
    ("studio", "dark and glossy", WardVariant.BOUNDED_2010): 0.054,
    ("studio", "glossy red", WardVariant.BOUNDED_2010): 0.063,
}
"""Strong lobes, whose tail (lamp) and rim (studio, Ward 1992) no GGX lobe has."""
EXPOSURE = 0.5
cases = pytest.mark.parametrize("name", MATERIALS)
variants = pytest.mark.parametrize("variant", WardVariant)


def of_variant(name, variant):
    return dataclasses.replace(MATERIALS[name], ward_variant=variant.value)


def under_a_lamp(estimate):
    return tone_map(render_point_light(estimate.ward, tuple(LIGHT), SIZE)) / 255


def in_the_studio(estimate):
    return masked(tone_map(render_environment(estimate.ward, studio(), SIZE), EXPOSURE) / 255)


def masked(picture):
    """Without what lies beside the sphere."""
    across = (np.arange(SIZE) + 0.5) * 2 / SIZE - 1
    is_sphere = np.add.outer(across**2, across**2) < 0.95**2
    return np.where(is_sphere[..., None], picture, 0.0)


def in_file(estimate, path):
    """The values of glTF's model: base colour, F0 and the width of the lobe."""
    export_estimate(estimate, "gltf", path)
    (material,) = json.loads(path.read_text())["materials"]
    pbr = material["pbrMetallicRoughness"]
    f0 = material["extensions"]["KHR_materials_specular"]["specularFactor"]
    return pbr["baseColorFactor"][:3], f0, pbr["roughnessFactor"] ** 2


def by_mitsuba(base, f0, width, light):
    """Linear radiance of glTF's model: a diffuse base under GGX facets of a constant F0."""
    scene = {
        "type": "scene",
        "integrator": {"type": "direct", "hide_emitters": True},
        "sensor": {
            "type": "orthographic",
            "to_world": mi.ScalarTransform4f()
            .look_at([0, -10, 0], [0, 0, 0], [0, 0, 1])
            .scale([1 / 0.95, 1 / 0.95, 1]),
            "film": {
                "type": "hdrfilm",
                "width": SIZE,
                "height": SIZE,
                "pixel_format": "rgb",
                "rfilter": {"type": "box"},
            },
        },
        "light": light,
        "shape": {
            "type": "sphere",
            "bsdf": {
                "type": "blendbsdf",
                "weight": f0,
                "base": {"type": "diffuse", "reflectance": {"type": "rgb", "value": base}},
                "facets": {
                    "type": "roughconductor",
                    "material": "none",
                    "distribution": "ggx",
                    "alpha": width,
                },
            },
        },
    }
    return np.array(mi.render(mi.load_dict(scene), spp=256), np.float64)


def lamp():
    irradiance = {"type": "rgb", "value": float(np.pi)}
    return {"type": "directional", "direction": (-LIGHT).tolist(), "irradiance": irradiance}


def studio_light():
    turn = mi.ScalarTransform4f().rotate([0, 0, 1], 90).rotate([1, 0, 0], 90)
    return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(studio())), "to_world": turn}


@cases
@variants
def test_the_gltf_model_under_a_lamp_is_near_wards(tmp_path, name, variant):
    estimate = of_variant(name, variant)
    values = in_file(estimate, tmp_path / "sphere.gltf")
    picture = masked(tone_map(by_mitsuba(*values, lamp())) / 255)
    found = image_distance(under_a_lamp(estimate), picture).flip
    assert found <= MORE.get(("lamp", name, variant), MOST)


@cases
@variants
def test_the_gltf_model_in_a_studio_is_near_wards(tmp_path, name, variant):
    estimate = of_variant(name, variant)
    base, f0, width = in_file(estimate, tmp_path / "sphere.gltf")
    reference = in_the_studio(estimate)

    def flip(*values):
        shown_by_mitsuba = tone_map(by_mitsuba(*values, studio_light()), EXPOSURE) / 255
        return image_distance(reference, masked(shown_by_mitsuba)).flip

    found = flip(base, f0, width)
    assert found <= MORE.get(("studio", name, variant), MOST)
    # Without the lobe, and with a roughness that is not squared, it is farther.
    assert found < 0.8 * flip(list(estimate.rho_d), 0.0, width)
    assert found < flip(base, f0, np.sqrt(width))


@cases
def test_the_glb_shown_by_three_js_is_near_wards(tmp_path, name):
    estimate = MATERIALS[name]
    export_estimate(estimate, "glb", tmp_path / "sphere.glb")
    x, y, z = LIGHT
    picture = shown(
        "view_glb.html",
        tmp_path,
        tmp_path / "three.png",
        file="files/sphere.glb",
        size=SIZE,
        half=0.05 / 0.95,
        # glTF has y up, and its camera stands at +z, which is the scan's -y.
        light=f"{x},{z},{-y}",
    )
    # Half a pixel of the silhouette comes on top, which three.js smooths.
    assert image_distance(under_a_lamp(estimate), picture).flip <= MOST + 0.01


def test_the_comparison_sees_another_roughness_and_another_colour():
    reference = in_the_studio(MATERIALS["glossy red"])
    for changes in ({"alpha": 0.3}, {"rho_d": (0.4, 0.2, 0.04)}, {"rho_s": 0.0}):
        other = in_the_studio(glossy_red(**changes))
        assert image_distance(reference, other).flip > 0.085
