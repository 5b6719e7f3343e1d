# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Fast pictures of any Ward BRDF under fixed lights.

Under an environment a picture is linear in ``rho_d`` and ``rho_s``. One irradiance map and the
specular response at a series of roughnesses, computed once, give every picture.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.brdf.models import Ward
from reflest_core.brdf.parameters import ALPHA, RHO_D, RHO_S
from reflest_core.brdf.sampling import sample_specular, specular_weight
from reflest_core.evaluation.pictures.rendered_shapes import Shape
from reflest_core.light.equirectangular import nearest_radiance
from reflest_core.rendering.environments import irradiance
from reflest_core.rendering.sphere import TOWARDS_CAMERA, local_frames
from reflest_core.synbrdf.scenes.exposure import auto_exposure

ALPHAS = np.geomspace(0.001, 0.5, 32)
"""The ladder of roughnesses."""
STRATA = 12
"""On each side: 144 directions in each pixel."""
WHITE_POINT = 0.9
"""sRGB-linear value of a white matt surface that faces the point light."""

Picture = NDArray[np.float64]


def point_light_directions(count: int = 4) -> NDArray[np.float64]:
    """Directions of a light that circles the camera's axis at 50 degrees.

    Args:
        count: Number of directions.

    Returns:
        (count, 3) float64, unit, towards the light.
    """
    turn = 2 * math.pi * (np.arange(count) + 0.5) / count
    aside = math.radians(50)
    return np.stack(
        [
            math.sin(aside) * np.cos(turn),
            np.full(count, -math.cos(aside)),
            math.sin(aside) * np.sin(turn),
        ],
        axis=-1,
    )


@dataclass(frozen=True)
class EnvironmentSwatch:
    """One shape under one environment.

    Attributes:
        shape: What is rendered; it has P pixels.
        light: The environment's name.
        diffuse: (P, 3) linear radiance of a white matt surface.
        glossy: (A, P, 3) linear radiance of ``rho_s`` = 1 at each of :data:`ALPHAS`.
        exposure: Factor on linear radiance before sRGB encoding.
    """

    shape: Shape
    light: str
    diffuse: NDArray[np.float64]
    glossy: NDArray[np.float64]
    exposure: float

    @staticmethod
    def prepare(shape: Shape, light: str, radiance: NDArray[np.float32]) -> EnvironmentSwatch:
        """Integrate the environment for every pixel and roughness.

        Args:
            shape: What is rendered.
            light: The environment's name.
            radiance: (H, 2 H, 3) linear, see :mod:`reflest_core.light.equirectangular`.
        """
        frames = local_frames(shape.normals)
        omega_o = np.einsum("pij,j->pi", frames, TOWARDS_CAMERA)[:, None]
        edge = np.arange(STRATA) / STRATA
        corners = np.stack(np.meshgrid(edge, edge, indexing="ij"), -1).reshape(1, -1, 2)
        shifts = np.random.default_rng(0).random((len(frames), 1, 2)) / STRATA
        glossy = np.empty((len(ALPHAS), len(frames), 3))
        for step, alpha in enumerate(ALPHAS):
            mirrored = sample_specular(alpha, omega_o, corners + shifts)
            weights = specular_weight(1.0, mirrored, omega_o)
            arriving = nearest_radiance(radiance, np.einsum("pji,psj->psi", frames, mirrored))
            glossy[step] = (weights[..., None] * arriving).mean(axis=1)
        diffuse = irradiance(radiance, shape.normals) / math.pi
        return EnvironmentSwatch(shape, light, diffuse, glossy, auto_exposure(radiance))

    def picture(self, ward: NDArray[np.float64]) -> Picture:
        """Render a material.

        Args:
            ward: (5,) Ward parameters.

        Returns:
            (SIZE, SIZE, 3) float64 sRGB in [0, 1]; black beside the shape.
        """
        place = np.interp(np.log(ward[ALPHA]), np.log(ALPHAS), np.arange(len(ALPHAS)))
        low = min(int(place), len(ALPHAS) - 2)
        share = place - low
        glossy = (1 - share) * self.glossy[low] + share * self.glossy[low + 1]
        radiance = ward[RHO_D] * self.diffuse + ward[RHO_S] * glossy
        return _picture(self.shape, radiance * self.exposure)


@dataclass(frozen=True)
class PointLightSwatch:
    """One shape under a distant lamp that lights a facing white matt surface to 0.9.

    Attributes:
        shape: What is rendered; it has P pixels.
        light: The lamp's name.
        omega_i: (P, 3) unit, towards the lamp, in each pixel's local frame.
        omega_o: (P, 3) unit, towards the camera, in each pixel's local frame.
    """

    shape: Shape
    light: str
    omega_i: NDArray[np.float64]
    omega_o: NDArray[np.float64]

    @staticmethod
    def prepare(shape: Shape, light: str, direction: NDArray[np.float64]) -> PointLightSwatch:
        """Transform the directions into the local frames of the shape's pixels.

        Args:
            shape: What is rendered.
            light: The lamp's name.
            direction: (3,) unit, towards the lamp.
        """
        frames = local_frames(shape.normals)
        omega_i, omega_o = (
            np.einsum("pij,j->pi", frames, towards) for towards in (direction, TOWARDS_CAMERA)
        )
        return PointLightSwatch(shape, light, omega_i, omega_o)

    def picture(self, ward: NDArray[np.float64]) -> Picture:
        """Render a material.

        Args:
            ward: (5,) Ward parameters.

        Returns:
            (SIZE, SIZE, 3) float64 sRGB in [0, 1]; black beside the shape.
        """
        value = Ward().evaluate(ward, self.omega_i, self.omega_o)
        cosine = np.clip(self.omega_i[:, 2:], 0, None)
        return _picture(self.shape, WHITE_POINT * math.pi * value * cosine)


Swatch = EnvironmentSwatch | PointLightSwatch


def _picture(shape: Shape, radiance: NDArray[np.float64]) -> Picture:
    image = np.zeros((*shape.inside.shape, 3))
    image[shape.inside] = srgb.encode(radiance)
    return image
