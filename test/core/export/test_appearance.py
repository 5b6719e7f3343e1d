# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The exported material looks like Ward's: pictures of spheres, compared by FLIP.

reflest's own renderer, three.js (the files themselves in headless Chromium) and Mitsuba (the model
of glTF) draw the same sphere under the same light.
"""

import json

import numpy as np
import pytest

from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.environment.environment_map import EnvironmentMap
from reflest_core.evaluation.pictures import exported_spheres
from reflest_core.evaluation.pictures.exported_spheres import (
    GLTF,
    LAMP,
    MATERIALS,
    STUDIO_EXPOSURE,
    USD,
    microfacet_pictures,
    ward_pictures,
)
from reflest_core.evaluation.pictures.image_distance import image_distance
from reflest_core.export.environment_file import environment_bytes
from reflest_core.export.exporter import export_estimate
from reflest_core.rendering.environments import studio
from reflest_core.rendering.sphere import tone_map
from reflest_core.synbrdf.path_tracing.ward_bsdf import mi
from test.core.export.estimates import glossy_red
from test.web.browser import shown

SIZE = exported_spheres.SIZE
MOST = 0.05
TOWARDS_LAMP = np.array(LAMP) / np.linalg.norm(LAMP)
STRONG = ("dark and glossy", "glossy red")
"""Where Ward 1992 loses more light at the rim than any value of the formats can take away."""


def ward_of(name, variant=WardVariant.WARD_1992):
    return WardParameters(*MATERIALS[name], variant)


def estimate_of(name, variant=WardVariant.WARD_1992):
    rho_d, rho_s, alpha = MATERIALS[name]
    return glossy_red(rho_d=rho_d, rho_s=rho_s, alpha=alpha, ward_variant=variant.value)


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize("variant", WardVariant)
def test_the_gltf_sphere_is_near_wards_under_both_lights(name, variant):
    ward = ward_of(name, variant)
    lamp, in_studio = ward_pictures(ward).flip(microfacet_pictures(ward, GLTF))
    assert lamp <= MOST
    if variant is WardVariant.BOUNDED_2010 or name not in STRONG:
        assert in_studio <= MOST


def test_the_comparison_sees_another_width_no_lobe_and_another_colour():
    ward = ward_of("glossy red", WardVariant.BOUNDED_2010)
    reference = ward_pictures(ward)
    found = reference.flip(microfacet_pictures(ward, GLTF))
    # A roughness that is not squared is about three times the width.
    for changes in ({"width_factor": 3.0}, {"f0_factor": 0.0}):
        other = reference.flip(microfacet_pictures(ward, GLTF, **changes))
        assert other.max() > max(MOST, 1.3 * found.max())
    redder = ward_pictures(WardParameters((0.4, 0.2, 0.04), 0.2, 0.1, WardVariant.BOUNDED_2010))
    assert (reference.flip(redder) > 0.085).all()


def inside(picture):
    """Without the silhouette."""
    across = (np.arange(SIZE) + 0.5) * 2 / SIZE - 1
    is_inside = np.add.outer(across**2, across**2) < 0.9**2
    return np.where(is_inside[..., None], picture, 0.0)


@pytest.fixture(scope="module")
def studio_file(tmp_path_factory):
    folder = tmp_path_factory.mktemp("studio")
    light = studio()
    share = np.ones(light.shape[:2], np.float32)
    content = environment_bytes(EnvironmentMap(light, share, 0 * share), "hdr")
    (folder / "studio.hdr").write_bytes(content)
    return folder


@pytest.mark.parametrize("suffix", ["glb", "usda"])
def test_the_file_shown_by_three_js_is_what_was_meant(studio_file, suffix):
    name = "glossy red"
    export_estimate(estimate_of(name), suffix[:3], studio_file / f"sphere.{suffix}")
    meant = microfacet_pictures(ward_of(name), GLTF if suffix == "glb" else USD)
    x, y, z = TOWARDS_LAMP
    # glTF has y up, and its camera stands at +z, which is the scan's -y.
    lights = {"light": f"{x},{z},{-y}"}, {"environment": "files/studio.hdr"}
    exposures = 1.0, STUDIO_EXPOSURE
    for expected, light, exposure in zip(
        (meant.lamp, meant.studio), lights, exposures, strict=True
    ):
        picture = shown(
            "view_glb.html",
            studio_file,
            studio_file / "three.png",
            file=f"files/sphere.{suffix}",
            size=SIZE,
            half=0.05 / 0.95,
            exposure=exposure,
            **light,
        )
        # It smooths the silhouette, and blurs an environment before it looks it up.
        assert image_distance(inside(expected), inside(picture)).flip <= MOST


def test_mitsuba_draws_the_values_in_the_file_alike(tmp_path):
    path = tmp_path / "sphere.gltf"
    export_estimate(estimate_of("glossy red"), "gltf", path)
    (material,) = json.loads(path.read_text())["materials"]
    pbr = material["pbrMetallicRoughness"]
    f0 = material["extensions"]["KHR_materials_specular"]["specularFactor"]
    irradiance = {"type": "rgb", "value": float(np.pi)}
    scene = {
        "type": "scene",
        "integrator": {"type": "direct"},
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
        "light": {
            "type": "directional",
            "direction": (-TOWARDS_LAMP).tolist(),
            "irradiance": irradiance,
        },
        "shape": {
            "type": "sphere",
            "bsdf": {
                "type": "blendbsdf",
                "weight": f0,
                "base": {
                    "type": "diffuse",
                    "reflectance": {"type": "rgb", "value": pbr["baseColorFactor"][:3]},
                },
                "facets": {
                    "type": "roughconductor",
                    "material": "none",
                    "distribution": "ggx",
                    "alpha": pbr["roughnessFactor"] ** 2,
                },
            },
        },
    }
    picture = tone_map(np.array(mi.render(mi.load_dict(scene), spp=64), np.float64)) / 255
    meant = microfacet_pictures(ward_of("glossy red"), GLTF).lamp
    assert image_distance(meant, picture).flip <= 0.02
