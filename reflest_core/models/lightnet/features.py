# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""lightnet's features: each observation beside what the known light would do there.

Everything is a ratio to the voxel's own diffuse light, so that neither exposure nor the light's
strength matters: with the true light, an observation of Eq. 1 satisfies, in every channel,
``apparent albedo = rho_d + rho_s * lobe(alpha)``.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.inference.gloss.posterior import gloss_posterior
from reflest_core.inference.light import seen_light
from reflest_core.inference.material import Explanation, explain
from reflest_core.inference.transport.irradiance import DARKEST, incoming, weighted_radiance
from reflest_core.inference.transport.ward_lobe import lobe_radiance
from reflest_core.light.completion import CLIPPED, RADIANCE, SEEN
from reflest_core.light.cosine_weights import cosine_weights
from reflest_core.models.lightnet.gloss_evidence import gloss_answers, gloss_evidence
from reflest_core.models.lightnet.light_zones import light_zones
from reflest_core.models.lightnet.lobe_fit import fit_lobes
from reflest_core.models.lightnet.scene_statistics import scene_statistics
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.surface_sample import sampled


@dataclass(frozen=True)
class LightFeatures:
    """V voxels with up to O observations each, K roughnesses; all float32 but ``is_seen``.

    Attributes:
        is_seen: (V, O) bool; where False, the other arrays hold zeros.
        apparent: (V, O, 3), linear colour over ``E(n) / pi``.
        clipped: (V, O, 3), 1 where the channel is at 255.
        cosine: (V, O), ``omega_o . n``.
        lobe: (V, O, K, 3), radiance reflected at ``rho_s = 1`` over ``E(n) / pi``.
        lobe_seen: (V, O, K), share of that lobe's light that was seen.
        lobe_clipped: (V, O, K), share of it that was seen clipped.
        normals: (V, 3).
        diffuse_light: (V, 3), ``E(n) / pi``.
        diffuse_seen: (V,), share of that light that was seen.
        diffuse_clipped: (V,), share of it that was seen clipped.
        voxel_fit: (V, 3, K, 3), see :class:`LobeFit`.
        scene_fit: (3, K, 3), see :class:`LobeFit`.
        zones: (8, 5), see :func:`light_zones`.
        channel_statistics: (3, C), see :class:`SceneStatistics`.
        statistics: (S,), see :class:`SceneStatistics`.
        found_albedo: (3, 3) by channel, see :attr:`Explanation.albedos`.
        found_gloss: (3,), see :attr:`Explanation.glosses`.
        gloss_evidence: (E,), see :func:`.gloss_evidence`.
        gloss_answers: (2,), see :func:`.gloss_answers`.
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
    channel_statistics: NDArray[np.float32]
    statistics: NDArray[np.float32]
    found_albedo: NDArray[np.float32]
    found_gloss: NDArray[np.float32]
    gloss_evidence: NDArray[np.float32]
    gloss_answers: NDArray[np.float32]


def light_features(
    surface: ObservedSurface,
    voxels: NDArray[np.int64],
    found: Explanation | None = None,
    without: tuple[str, ...] = (),
) -> LightFeatures:
    """Compute the features of voxels of a surface.

    Args:
        surface: A scan, or a material's part of one, upright (+z is up).
        voxels: (V,) indices into ``surface``.
        found: The surface as a material in the light of its scene; None explains it as a scene of
            one material by the light that it was seen in, or by an assumed one if none was seen.
        without: For ablations. ``completion`` leaves the light smoothly filled where it was not
            seen, ``visibility`` lets the surface hide no light from itself.
    """
    found = found or explained(surface, "visibility" not in without)
    if "completion" in without:
        found = dataclasses.replace(found, light=found.filled)
    return features_of(found, voxels)


def explained(surface: ObservedSurface, has_visibility: bool = True) -> Explanation:
    """Explain a surface as a scene of one material, with the posterior of its roughness.

    Args:
        surface: Upright (+z is up), with the light that it was seen in; one is assumed if none was.
        has_visibility: False lets the surface hide no light from itself.
    """
    found = explain(surface, seen_light(surface), has_visibility)
    posterior = gloss_posterior(surface, found.filled, [np.arange(surface.voxel_count)])
    return dataclasses.replace(found, posterior=posterior)


def features_of(found: Explanation, voxels: NDArray[np.int64]) -> LightFeatures:
    """Compare what was observed of voxels with what the light would do there.

    Args:
        found: The material and the light that it is in.
        voxels: (V,) indices into the material's surface.
    """
    return features_of_choices(found, [voxels])[0]


def features_of_choices(
    found: Explanation, choices: Sequence[NDArray[np.int64]]
) -> list[LightFeatures]:
    """Do as :func:`features_of` for several choices of voxels; what they share is computed once.

    Args:
        found: The material and the light that it is in.
        choices: (V,) indices into the material's surface, of each choice.

    Returns:
        The features of each choice.
    """
    surface = found.surface
    sample = sampled(surface, np.concatenate(choices))
    weights = cosine_weights(sample.normals)
    sight = found.occluders.sight(surface.positions[sample.voxels], sample.normals, weights)
    diffuse = weighted_radiance(found.light, incoming(weights, sight))
    diffuse_light = np.maximum(diffuse[:, RADIANCE], DARKEST)
    lobes = lobe_radiance(
        found.light, sample.normals[sample.voxel_of], sample.directions, sight.of(sample.voxel_of)
    )
    of_observation = diffuse_light[sample.voxel_of]
    is_seen = sample.spread(np.ones(len(sample.voxel_of), np.float32))
    apparent = sample.spread(sample.colours / of_observation)
    clipped = sample.spread(sample.clipped.astype(np.float32))
    cosine = sample.spread(
        np.einsum("ij,ij->i", sample.directions, sample.normals[sample.voxel_of])
    )
    lobe = sample.spread(lobes[..., RADIANCE] / of_observation[:, None])
    lobe_seen, lobe_clipped = sample.spread(lobes[..., SEEN]), sample.spread(lobes[..., CLIPPED])
    brightness = diffuse_light.mean(axis=1)
    zones, statistics = light_zones(found.light), scene_statistics(found)
    made, last = [], 0
    for choice in choices:
        of = slice(last, last + len(choice))
        last = of.stop
        fit = fit_lobes(
            apparent[of],
            lobe[of],
            is_seen[of, :, None] * (1.0 - clipped[of]),
            np.minimum(brightness[of] / max(float(brightness[of].mean()), DARKEST), 1.0) ** 2,
        )
        made.append(
            LightFeatures(
                is_seen=is_seen[of] > 0.0,
                apparent=apparent[of],
                clipped=clipped[of],
                cosine=cosine[of],
                lobe=lobe[of],
                lobe_seen=lobe_seen[of],
                lobe_clipped=lobe_clipped[of],
                normals=sample.normals[of],
                diffuse_light=diffuse_light[of],
                diffuse_seen=diffuse[of, SEEN],
                diffuse_clipped=diffuse[of, CLIPPED],
                voxel_fit=fit.voxels,
                scene_fit=fit.scene,
                zones=zones,
                channel_statistics=statistics.of_channels,
                statistics=statistics.of_all,
                found_albedo=found.albedos,
                found_gloss=found.glosses,
                gloss_evidence=gloss_evidence(found.posterior),
                gloss_answers=gloss_answers(found.posterior),
            )
        )
    return made
