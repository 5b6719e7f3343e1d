# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A sphere with a Ward BRDF, seen from far along -y: the swatch that people judge materials by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.models import Ward
from reflest_core.brdf.parameters import WardParameters
from reflest_core.brdf.protocol import BrdfModel
from reflest_core.brdf.srgb import encode
from reflest_core.light.equirectangular import nearest_radiance
from reflest_core.rendering.environments import irradiance

TOWARDS_CAMERA = np.array([0.0, -1.0, 0.0])
FILLED = 0.95
"""Diameter of the sphere over the picture's edge."""
SAMPLES = 12
"""Strata on each side: 144 directions in each pixel."""

PIXELS_AT_ONCE = 1024
"""Their samples fit into the processor's cache."""

Image = NDArray[np.float64]


def render_environment(
    parameters: WardParameters, environment: NDArray[np.float32], size: int = 256
) -> Image:
    """Render a sphere lit by an environment, which is also the background.

    World: z up, camera at -y. The diffuse lobe sums over the whole map; the specular lobe is
    importance-sampled on strata that a fixed seed shifts in each pixel, so the picture repeats.

    Args:
        parameters: The material.
        environment: (H, 2 H, 3) linear radiance, equirectangular.
        size: Pixels along an edge.

    Returns:
        (size, size, 3) linear radiance.
    """
    diffuse = np.array(parameters.rho_d) / np.pi * irradiance(environment, sphere_normals(size))
    model = Ward(parameters.variant)
    return render_lobe(model, np.array(parameters.vector), environment, diffuse, size)


def render_lobe(
    model: BrdfModel,
    material: NDArray[np.float64],
    environment: NDArray[np.float32],
    diffuse: NDArray[np.float64],
    size: int,
) -> Image:
    """Render any model's specular lobe over given diffuse light (:func:`render_environment`).

    Args:
        model: The BRDF.
        material: (P,) vector of its parameters.
        environment: (H, 2 H, 3) linear radiance, equirectangular.
        diffuse: (N, 3) linear radiance at the pixels of :func:`on_sphere`.
        size: Pixels along an edge.

    Returns:
        (size, size, 3) linear radiance.
    """
    normals = sphere_normals(size)
    frames = local_frames(normals)
    omega_o = np.einsum("pij,j->pi", frames, TOWARDS_CAMERA)[:, None]
    shifts = np.random.default_rng(0).random((len(normals), 1, 2))
    radiance = np.array(diffuse)
    for first in range(0, len(normals), PIXELS_AT_ONCE):
        some = slice(first, first + PIXELS_AT_ONCE)
        mirrored, weights = model.sample(material, omega_o[some], _strata(shifts[some]))
        arriving = nearest_radiance(environment, np.einsum("pji,psj->psi", frames[some], mirrored))
        radiance[some] += (weights[..., None] * arriving).mean(axis=1)

    image = nearest_radiance(environment, _background_directions(size))
    image[on_sphere(size)] = radiance
    return image


def render_point_light(
    parameters: WardParameters, direction: tuple[float, float, float], size: int = 256
) -> Image:
    """Render a sphere under a distant light of irradiance pi, before black.

    Args:
        parameters: The material.
        direction: Towards the light, world frame, any length.
        size: Pixels along an edge.

    Returns:
        (size, size, 3) linear radiance.
    """
    model = Ward(parameters.variant)
    return render_lamp(model, np.array(parameters.vector), direction, size)


def render_lamp(
    model: BrdfModel,
    material: NDArray[np.float64],
    direction: tuple[float, float, float],
    size: int,
) -> Image:
    """Render any model, as :func:`render_point_light`.

    Args:
        model: The BRDF.
        material: (P,) vector of its parameters.
        direction: Towards the light, world frame, any length.
        size: Pixels along an edge.

    Returns:
        (size, size, 3) linear radiance.
    """
    frames = local_frames(sphere_normals(size))
    towards_light = np.array(direction) / np.linalg.norm(direction)
    omega_i = np.einsum("pij,j->pi", frames, towards_light)
    omega_o = np.einsum("pij,j->pi", frames, TOWARDS_CAMERA)
    value = model.evaluate(material, omega_i, omega_o)
    image = np.zeros((size, size, 3))
    image[on_sphere(size)] = np.pi * value * np.clip(omega_i[:, 2:], 0, None)
    return image


def tone_map(linear: Image, exposure: float = 1.0) -> NDArray[np.uint8]:
    """Encode linear radiance, clipped at white.

    Args:
        linear: (..., 3) linear radiance.
        exposure: Factor before encoding.

    Returns:
        (..., 3) 8-bit sRGB.
    """
    encoded: NDArray[np.float64] = encode(linear * exposure)
    return np.round(encoded * 255).astype(np.uint8)


def on_sphere(size: int) -> NDArray[np.bool_]:
    """Which pixels show the sphere.

    Args:
        size: Pixels along an edge.

    Returns:
        (size, size).
    """
    x, down = _places(size)
    return np.asarray(x**2 + down**2 < 1.0)


def _places(size: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """(size, size) each, right and down from the middle, in radii of the sphere."""
    across = ((np.arange(size) + 0.5) * 2 / size - 1) / FILLED
    x, down = np.meshgrid(across, across)
    return x, down


def sphere_normals(size: int) -> NDArray[np.float64]:
    """World normals of the pixels of :func:`on_sphere`.

    Args:
        size: Pixels along an edge.

    Returns:
        (N, 3) unit.
    """
    inside = on_sphere(size)
    x, down = (place[inside] for place in _places(size))
    return np.stack([x, -np.sqrt(1 - x**2 - down**2), -down], axis=-1)


def _background_directions(size: int) -> NDArray[np.float64]:
    """Directions (size, size, 3) of a 60 degree view past the sphere, along +y."""
    across = ((np.arange(size) + 0.5) * 2 / size - 1) * np.tan(np.radians(30))
    x, down = np.meshgrid(across, across)
    rays = np.stack([x, np.ones_like(x), -down], axis=-1)
    directions: NDArray[np.float64] = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    return directions


def local_frames(normals: NDArray[np.float64]) -> NDArray[np.float64]:
    """Make a local frame at each of P normals.

    Args:
        normals: (P, 3) unit.

    Returns:
        (P, 3, 3) rotations from the world to frames with +z on the normal.
    """
    helper = np.where(np.abs(normals[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 0.0, 1.0]])
    tangent = np.cross(helper, normals)
    tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
    return np.stack([tangent, np.cross(normals, tangent), normals], axis=1)


def _strata(shifts: NDArray[np.float64]) -> NDArray[np.float64]:
    """(P, SAMPLES^2, 2) points, one in each stratum; ``shifts`` (P, 1, 2) in [0, 1) place them."""
    edge = np.arange(SAMPLES) / SAMPLES
    corners = np.stack(np.meshgrid(edge, edge, indexing="ij"), axis=-1).reshape(1, -1, 2)
    points: NDArray[np.float64] = corners + shifts / SAMPLES
    return points
