# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Diffuse light on a surface of any normal, and how much of its origin was seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.transport.patch_grid import patch_shares, patches_of_texels
from reflest_core.inference.transport.visibility import Sight
from reflest_core.light.completion import LightPyramid
from reflest_core.light.cosine_weights import SIZE, cosine_weights

DARKEST = 1e-4
"""``E(n) / pi`` that a ratio is taken to at least, in units of the sensor's white."""


@dataclass(frozen=True)
class Incoming:
    """From where light comes to V voxels, weighted by cosine.

    Attributes:
        weights: (V, SIZE * SIZE) share of each texel's radiance in ``E(n) / pi``.
        hidden: (V,) share of the light that the scene hides; with the weights it sums to 1.
        own: (V, 3) what the scene sends from there.
    """

    weights: NDArray[np.float32]
    hidden: NDArray[np.float32]
    own: NDArray[np.float32]


def incoming(weights: NDArray[np.float32], sight: Sight | None = None) -> Incoming:
    """Weigh the directions from which light comes to V voxels.

    Args:
        weights: (V, SIZE * SIZE) of :func:`.cosine_weights`.
        sight: what the voxels see past the scene; None where nothing is hidden.
    """
    if sight is None:
        nothing = np.zeros(len(weights), np.float32)
        return Incoming(weights, nothing, np.zeros((len(weights), 3), np.float32))
    # np.take copies columns faster than an index does.
    whole, weights = weights, weights * np.take(sight.visible, patches_of_texels(SIZE), axis=1)
    if sight.is_coloured:
        by_patch = patch_shares(whole) * (np.float32(1.0) - sight.visible)
        own = np.einsum("vp,vpc->vc", by_patch, sight.own)
        return Incoming(weights, by_patch.sum(axis=1), np.asarray(own, np.float32))
    hidden = np.maximum(np.float32(1.0) - weights.sum(axis=1), np.float32(0.0))
    return Incoming(weights, hidden, hidden[:, None] * sight.own)


def mean_radiance(
    light: LightPyramid, normals: NDArray[np.float32], sight: Sight | None = None
) -> NDArray[np.float32]:
    """Average the light over the hemisphere of each normal, weighted by cosine.

    Args:
        light: the completed light.
        normals: (V, 3) unit.
        sight: what the voxels see past the scene; None where nothing is hidden.

    Returns:
        (V, 5): ``E(n) / pi``, the radiance that a white Lambertian surface would send back; then
        the seen and the saturated share of that light.
    """
    return weighted_radiance(light, incoming(cosine_weights(normals), sight))


def weighted_radiance(light: LightPyramid, arriving: Incoming) -> NDArray[np.float32]:
    """Average the light where it is known from where it comes; the scene itself counts as seen.

    Args:
        light: the completed light.
        arriving: of V voxels.

    Returns:
        (V, 5), see :func:`mean_radiance`.
    """
    level = next(level for level in light.levels if len(level) == SIZE)
    mean = np.asarray(arriving.weights @ level.reshape(-1, 5), np.float32)
    mean[:, :3] += arriving.own
    mean[:, 3] += arriving.hidden
    return mean
