# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Each observation beside what the known light would do there: the input of ``lightnet``.

Everything is a ratio to the voxel's own diffuse light, so that neither exposure nor the light's
strength matters: with the true light, an observation of Eq. 1 satisfies, in every channel,
``apparent albedo = rho_d + rho_s * lobe(alpha)``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.features.light.completion import complete
from reflest_core.features.light.irradiance import mean_radiance
from reflest_core.features.light.light_zones import light_zones
from reflest_core.features.light.lobe_fit import fit_lobes
from reflest_core.features.light.ward_lobe import lobe_radiance
from reflest_core.fusion.light_map import ObservedLight
from reflest_core.fusion.observed_surface import ObservedSurface

OBSERVATIONS = 12
"""Of one voxel at most; more are thinned evenly over the order in which they were made."""
DARKEST = 1e-4
"""``E(n) / pi`` that a ratio is taken to at least, in units of the sensor's white."""
_LINEAR = np.asarray(srgb.decode(np.arange(256) / 255.0), np.float32)


@dataclass(frozen=True)
class Shading:
    """V voxels with up to O observations each, K roughnesses; all float32 but ``is_seen``.

    ``is_seen``: (V, O) bool; where False, the other arrays hold zeros.
    ``apparent``: (V, O, 3), linear colour over ``E(n) / pi``. ``clipped``: (V, O, 3), 1 where the
    channel is at 255. ``cosine``: (V, O), ``omega_o . n``.
    ``lobe``: (V, O, K, 3), radiance reflected at ``rho_s = 1`` over ``E(n) / pi``.
    ``lobe_seen``, ``lobe_clipped``: (V, O, K), shares of that lobe's light.
    ``normals``: (V, 3). ``diffuse_light``: (V, 3), ``E(n) / pi``. ``diffuse_seen``,
    ``diffuse_clipped``: (V,), shares of that light. ``voxel_fit``: (V, 3, K, 3) and ``scene_fit``:
    (3, K, 3), see :class:`LobeFit`. ``zones``: see :func:`light_zones`.
    """

    is_seen: NDArray[np.bool_]
    apparent: NDArray[np.float32]
    clipped: NDArray[np.float32]
    cosine: NDArray[np.float32]
    lobe: NDArray[np.float32]
    lobe_seen: NDArray[np.float32]
    lobe_clipped: NDArray[np.float32]
    normals: NDArray[np.float32]
    diffuse_light: NDArray[np.float32]
    diffuse_seen: NDArray[np.float32]
    diffuse_clipped: NDArray[np.float32]
    voxel_fit: NDArray[np.float32]
    scene_fit: NDArray[np.float32]
    zones: NDArray[np.float32]


def shading(surface: ObservedSurface, light: ObservedLight, voxels: NDArray[np.int64]) -> Shading:
    """What the light explains of the observations of ``voxels``, indices into ``surface``."""
    rows, voxel_of, slot = chosen_observations(surface, voxels)
    normals = surface.normals[voxels]
    towards = surface.view_centres[surface.view_indices[rows]] - surface.positions[voxels][voxel_of]
    directions = towards / np.linalg.norm(towards, axis=1, keepdims=True)
    pyramid = complete(light)
    diffuse = mean_radiance(pyramid, normals)
    diffuse_light = np.maximum(diffuse[:, :3], DARKEST)
    lobes = lobe_radiance(pyramid, normals[voxel_of], directions)
    colours = surface.colours[rows]

    def spread(values: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
        """(O, ...) of the observations to (V, O, ...), zeros where there is none."""
        grid = np.zeros((len(voxels), OBSERVATIONS, *values.shape[1:]), np.float32)
        grid[voxel_of, slot] = values
        return grid

    is_seen = spread(np.ones(len(rows), np.float32))
    apparent = spread(_LINEAR[colours] / diffuse_light[voxel_of])
    clipped = spread((colours == 255).astype(np.float32))
    lobe = spread(lobes[..., :3] / diffuse_light[voxel_of, None])
    brightness = diffuse_light.mean(axis=1)
    fit = fit_lobes(
        apparent,
        lobe,
        is_seen[..., None] * (1.0 - clipped),
        np.minimum(brightness / max(float(brightness.mean()), DARKEST), 1.0) ** 2,
    )
    return Shading(
        is_seen=is_seen > 0.0,
        apparent=apparent,
        clipped=clipped,
        cosine=spread(np.einsum("ij,ij->i", directions, normals[voxel_of])),
        lobe=lobe,
        lobe_seen=spread(lobes[..., 3]),
        lobe_clipped=spread(lobes[..., 4]),
        normals=normals,
        diffuse_light=diffuse_light,
        diffuse_seen=diffuse[:, 3],
        diffuse_clipped=diffuse[:, 4],
        voxel_fit=fit.voxels,
        scene_fit=fit.scene,
        zones=light_zones(pyramid),
    )


def chosen_observations(
    surface: ObservedSurface, voxels: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Rows of the chosen observations, each one's place in ``voxels``, and its slot there."""
    first, counts = surface.offsets[voxels], surface.observation_counts[voxels]
    taken = np.minimum(counts, OBSERVATIONS)
    voxel_of = np.repeat(np.arange(len(voxels)), taken)
    slot = np.arange(len(voxel_of)) - np.repeat(np.cumsum(taken) - taken, taken)
    step = slot * counts[voxel_of] // np.maximum(taken[voxel_of], 1)
    return first[voxel_of] + step, voxel_of, slot
