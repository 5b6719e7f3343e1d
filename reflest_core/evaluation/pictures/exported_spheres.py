# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How near the exported microfacet material comes to Ward's: FLIP between pictures of spheres.

``python -m reflest_core.evaluation.pictures.exported_spheres`` prints the tables of
``docs/export.md``. Both models are rendered by the same code under the same light: a lamp, and the
studio of :mod:`reflest_core.rendering.environments`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.models import Ggx
from reflest_core.brdf.parameters import WardParameters, WardVariant
from reflest_core.evaluation.pictures.image_distance import image_distance
from reflest_core.export.microfacet_material import NARROWER, MicrofacetMaterial, base_colour
from reflest_core.light.equirectangular import equirectangular_directions
from reflest_core.rendering.environments import irradiance, studio
from reflest_core.rendering.sphere import (
    TOWARDS_CAMERA,
    Image,
    on_sphere,
    render_environment,
    render_lamp,
    render_lobe,
    render_point_light,
    sphere_normals,
    tone_map,
)

SIZE = 96
"""Pixels along a picture's edge."""
LAMP = (0.5, -0.8, 0.6)
"""Direction towards the lamp: right of, above and behind the camera."""
STUDIO_EXPOSURE = 0.5
MATERIALS = {
    "satin": ((0.2, 0.2, 0.25), 0.05, 0.2),
    "polished": ((0.5, 0.4, 0.3), 0.03, 0.04),
    "plastic": ((0.1, 0.3, 0.15), 0.06, 0.1),
    "dark and glossy": ((0.03, 0.03, 0.03), 0.1, 0.1),
    "glossy red": ((0.4, 0.08, 0.04), 0.2, 0.1),
}
"""``rho_d``, ``rho_s`` and ``alpha`` by name."""
GLTF, USD = Ggx(f90=None), Ggx(f90=1.0)
"""What viewers of both formats make of the values: see ``docs/export.md``."""
F0_FACTORS = (0.7, 0.85, 1.0, 1.2)
WIDTH_FACTORS = (0.6, 0.8, 1.0, 1.2)


@dataclass(frozen=True)
class Pictures:
    """A sphere under both lights.

    Attributes:
        lamp: (SIZE, SIZE, 3) sRGB in [0, 1], before black.
        studio: The same; the studio itself is left out.
    """

    lamp: Image
    studio: Image

    def flip(self, other: Pictures) -> NDArray[np.float64]:
        """(2,) FLIP of another sphere from this one, under the lamp and in the studio.

        Args:
            other: The other sphere.
        """
        return np.array(
            [
                image_distance(self.lamp, other.lamp).flip,
                image_distance(self.studio, other.studio).flip,
            ]
        )


def ward_pictures(ward: WardParameters) -> Pictures:
    """Render Ward's sphere.

    Args:
        ward: The material.
    """
    return _pictures(render_point_light(ward, LAMP, SIZE), render_environment(ward, studio(), SIZE))


def microfacet_pictures(
    ward: WardParameters, model: Ggx, f0_factor: float = 1.0, width_factor: float = 1.0
) -> Pictures:
    """Render the sphere that stands for Ward's in a file.

    Args:
        ward: The material.
        model: :data:`GLTF` or :data:`USD`.
        f0_factor: Times the exported reflectance; the base follows.
        width_factor: Times the exported width of the lobe.
    """
    exported = MicrofacetMaterial.from_ward(ward)
    f0, width = exported.f0 * f0_factor, exported.roughness**2 * width_factor
    base = base_colour(np.array(ward.rho_d), np.array(f0))
    material = np.array([*base, f0, width])
    light = studio()
    # The camera is far away: what the facets let through depends on the light's direction alone.
    directions = equirectangular_directions(len(light))
    passed = 1 - model.fresnel(np.float64(f0), directions, TOWARDS_CAMERA)
    below = (light * passed[..., None]).astype(np.float32)
    diffuse = base / math.pi * irradiance(below, sphere_normals(SIZE))
    return _pictures(
        render_lamp(model, material, LAMP, SIZE), render_lobe(model, material, light, diffuse, SIZE)
    )


def least_flip(ward: WardParameters, model: Ggx) -> NDArray[np.float64]:
    """(2,) least FLIP under each light that any reflectance and width reach, of a grid.

    Args:
        ward: The material.
        model: :data:`GLTF` or :data:`USD`.
    """
    reference = ward_pictures(ward)
    found = [
        reference.flip(microfacet_pictures(ward, model, f0, width))
        for f0 in F0_FACTORS
        for width in WIDTH_FACTORS
    ]
    return np.asarray(np.min(found, axis=0))


def _pictures(lamp: Image, surrounded: Image) -> Pictures:
    lit = tone_map(surrounded, STUDIO_EXPOSURE) / 255
    return Pictures(tone_map(lamp) / 255, np.where(on_sphere(SIZE)[..., None], lit, 0.0))


def main() -> None:
    """Print FLIP of each material, and how it changes with the width of the lobe."""
    for variant in WardVariant:
        print(f"\n{variant.value}: FLIP under the lamp / in the studio\n")
        print("| material | `rho_s`, `alpha` | glTF | least, glTF | USD | least, USD |")
        print("|---|---|---|---|---|---|")
        for name, (rho_d, rho_s, alpha) in MATERIALS.items():
            ward = WardParameters(rho_d, rho_s, alpha, variant)
            reference = ward_pictures(ward)
            cells = []
            for model in (GLTF, USD):
                for flip in (
                    reference.flip(microfacet_pictures(ward, model)),
                    least_flip(ward, model),
                ):
                    cells.append(" / ".join(f"{value:.3f}" for value in flip))
            print(f"| {name} | {rho_s}, {alpha} | " + " | ".join(cells) + " |", flush=True)
    print("\nmean FLIP of all, glTF, by the factor on the RMS fit's width\n")
    wards = [
        WardParameters(*values, variant) for values in MATERIALS.values() for variant in WardVariant
    ]
    references = [ward_pictures(ward) for ward in wards]
    for factor in (0.5, 0.6, NARROWER, 0.8, 0.9, 1.0):
        flips = [
            reference.flip(microfacet_pictures(ward, GLTF, width_factor=factor / NARROWER))
            for reference, ward in zip(references, wards, strict=True)
        ]
        print(f"{factor:.2f}: {np.mean(flips):.4f}", flush=True)


if __name__ == "__main__":
    main()
