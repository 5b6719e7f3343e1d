# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""lightnet as it runs while scanning: NumPy alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import RHO_D, RHO_S
from reflest_core.inference.material import Explanation
from reflest_core.light.completion import CLIPPED, RADIANCE, SEEN
from reflest_core.models.definition import Scores
from reflest_core.models.lightnet.features import LightFeatures, explained, features_of_choices
from reflest_core.models.lightnet.shapes import FOUND_STRENGTHS
from reflest_core.models.linear_algebra import DenseLayer, one_blas_thread
from reflest_core.models.weights import Tensors
from reflest_core.surface.observed_surface import ObservedSurface

Array = NDArray[np.float32]

FLOOR = 0.03
"""Added before a logarithm; ratios below it count as dark."""
FURTHEST = 4.0
"""Standard deviations from the mean at which a statistic is held."""


class LiveLightNet:
    """The network of ``models/lightnet/network.py`` with its ``tensors``."""

    def __init__(self, tensors: Tensors) -> None:
        """Take the weights.

        Args:
            tensors: The trained weights by name.
        """
        self._observation = _two_layers(tensors, "observation")
        self._voxel = _two_layers(tensors, "voxel")
        self._attention = DenseLayer.of(tensors, "attention")
        self._channel = _two_layers(tensors, "channel")
        self._gloss = _two_layers(tensors, "gloss")
        self._of_channel = _Standard.of(tensors, "of_channel")
        self._of_all = _Standard.of(tensors, "of_all")
        self._diffuse = _two_layers(tensors, "diffuse")
        self._diffuse_head = DenseLayer.of(tensors, "diffuse_head")
        self._strength_head = DenseLayer.of(tensors, "strength_head")
        self._roughness_head = DenseLayer.of(tensors, "roughness_head")
        self._found_scale = tensors["found_scale"]
        self._update = DenseLayer.of(tensors, "update")
        self._update_gloss = DenseLayer.of(tensors, "update_gloss")
        self._update_albedo = DenseLayer.of(tensors, "update_albedo")

    def scores(
        self,
        surface: ObservedSurface,
        choices: Sequence[NDArray[np.int64]],
        found: Explanation | None = None,
    ) -> list[Scores]:
        """Estimate from the features of the voxels.

        Args:
            surface: A scan, or a material's part of one, upright (+z is up).
            choices: (N,) indices of voxels, all observed, of each choice.
            found: The material in the light of its scene; None takes the surface for a scene of
                one material.
        """
        return self.evaluate_choices(features_of_choices(found or explained(surface), choices))

    def evaluate(self, features: LightFeatures) -> tuple[Array, Array]:
        """Estimate means and log variances, (5,) each, of the z-scored parameters.

        Args:
            features: Of one surface.
        """
        (scores,) = self.evaluate_choices([features])
        assert scores.log_variances is not None
        return scores.means, scores.log_variances

    def evaluate_choices(self, features: Sequence[LightFeatures]) -> list[Scores]:
        """Estimate from each of several choices of voxels.

        Args:
            features: Of each choice.
        """
        with one_blas_thread():
            pooled = self._pooled(features)
            of_channel = self._of_channel.scores(np.stack([_of_channel(of) for of in features]))
            of_all = self._of_all.scores(np.stack([_of_all(of) for of in features]))
            shared = np.concatenate([of_channel.mean(axis=1), of_all], axis=-1)[:, None]
            shared = np.broadcast_to(shared, (*of_channel.shape[:2], shared.shape[-1]))
            channels = _run(self._channel, np.concatenate([pooled, of_channel, shared], axis=-1))
            gloss = _run(
                self._gloss, np.concatenate([channels.mean(axis=1), channels.max(axis=1)], axis=-1)
            )
            beside = np.broadcast_to(gloss[:, None], (*channels.shape[:2], gloss.shape[-1]))
            diffuse = self._diffuse_head.linear(
                _run(self._diffuse, np.concatenate([channels, beside], axis=-1))
            )
            strength = self._strength_head.linear(gloss)
            roughness = self._roughness_head.linear(gloss)
            heads = zip(diffuse, strength, roughness, strict=True)
            return [
                Scores(*self._updated(*self._answers(head, of), of))
                for head, of in zip(heads, features, strict=True)
            ]

    def _answers(
        self, heads: tuple[Array, Array, Array], features: LightFeatures
    ) -> tuple[Array, Array]:
        """The answer, (5,) each, before the posterior of roughness is known."""
        found = (
            features.found_albedo,
            features.found_gloss[:FOUND_STRENGTHS],
            features.found_gloss[FOUND_STRENGTHS:],
        )
        answers = [
            _answer(np.atleast_2d(head), np.atleast_2d(of * scale))
            for head, of, scale in zip(heads, found, self._found_scale, strict=True)
        ]
        means, log_variances = (np.concatenate(parts) for parts in zip(*answers, strict=True))
        return means, log_variances

    def _updated(
        self, means: Array, log_variances: Array, features: LightFeatures
    ) -> tuple[Array, Array]:
        """The answer, (5,) each, given the posterior of roughness."""
        answers = features.gloss_answers * self._found_scale[1:]
        hidden = _run(
            (self._update,),
            np.concatenate([features.gloss_evidence, means[RHO_S:], log_variances[RHO_S:]]),
        )
        weights, added, widened = np.split(self._update_gloss.linear(hidden), 3)
        own = np.stack([means[RHO_D], log_variances[RHO_D]], axis=-1)
        inputs = np.concatenate([np.broadcast_to(hidden, (3, len(hidden))), own], axis=-1)
        albedo = self._update_albedo.linear(inputs)
        gloss = means[RHO_S:] + weights * (answers - means[RHO_S:]) + added
        return (
            np.concatenate([means[RHO_D] + albedo[:, 0], gloss]),
            log_variances + np.concatenate([albedo[:, 1], widened]),
        )

    def _pooled(self, features: Sequence[LightFeatures]) -> Array:
        """(B, 3, width): by choice and channel, weighted means and spreads over the voxels."""
        described = self._described_voxels(features)
        attention = self._attention.linear(described.reshape(-1, described.shape[-1]))
        attention = attention.reshape(*described.shape[:-1], -1)
        width = described.shape[-1] // attention.shape[-1]
        pooled, first = [], 0
        for of_choice in features:
            of = slice(first, first + len(of_choice.is_seen))
            first = of.stop
            voxels, weights = described[of], attention[of]
            weights = np.exp(weights - weights.max(axis=0))
            weights /= weights.sum(axis=0)
            weighed = (np.repeat(weights, width, axis=-1) * voxels).sum(axis=0)
            spread = np.sqrt(voxels.var(axis=0) + np.float32(1e-6))
            pooled.append(np.concatenate([weighed, spread], axis=-1))
        return np.stack(pooled)

    def _described_voxels(self, choices: Sequence[LightFeatures]) -> Array:
        """(V, 3, width): every voxel by channel, from the observations that were made of it."""
        parts = [_observed(features) for features in choices]
        observations, counts = (np.concatenate(part) for part in zip(*parts, strict=True))
        described = _run(self._observation, observations)
        starts = np.cumsum(counts) - counts
        norm = counts[:, None, None].astype(np.float32)
        mean = np.add.reduceat(described, starts, axis=0) / norm
        difference = described - np.repeat(mean, counts, axis=0)
        squares = np.add.reduceat(difference * difference, starts, axis=0) / norm
        greatest = np.maximum.reduceat(described, starts, axis=0)
        beside = np.concatenate([_beside(features) for features in choices])
        deviation = np.sqrt(squares + np.float32(1e-6))
        return _run(self._voxel, np.concatenate([mean, deviation, greatest, beside], axis=-1))


def _of_channel(features: LightFeatures) -> Array:
    """(3, C): what the network reads of the whole scene, by channel."""
    mean_light = features.diffuse_light.mean(axis=0)
    zone_light = _log(features.zones[:, RADIANCE] / mean_light).T
    return np.concatenate(
        [features.channel_statistics, features.scene_fit.reshape(3, -1), zone_light], axis=-1
    )


def _of_all(features: LightFeatures) -> Array:
    """(S,): what it reads of the whole scene, of all channels."""
    return np.concatenate(
        [features.statistics, features.zones[:, SEEN], features.zones[:, CLIPPED]]
    )


def _observed(features: LightFeatures) -> tuple[Array, NDArray[np.int64]]:
    """(R, 3, C): what it reads of each observation, grouped by voxel; and how many a voxel has."""
    voxel_of, slot = np.nonzero(features.is_seen)
    rows = len(voxel_of)
    shares = np.concatenate([features.lobe_seen, features.lobe_clipped], axis=-1)[voxel_of, slot]
    observations = np.concatenate(
        [
            _log(features.apparent[voxel_of, slot])[..., None],
            features.clipped[voxel_of, slot][..., None],
            np.broadcast_to(features.cosine[voxel_of, slot][:, None, None], (rows, 3, 1)),
            _log(features.lobe[voxel_of, slot]).transpose(0, 2, 1),
            np.broadcast_to(shares[:, None], (rows, 3, shares.shape[-1])),
        ],
        axis=-1,
    )
    return observations, features.is_seen.sum(axis=1)


def _beside(features: LightFeatures) -> Array:
    """(V, 3, C): what it reads of each voxel beside its observations."""
    voxels = len(features.is_seen)
    count = features.is_seen.sum(axis=1)
    known = np.stack([features.diffuse_seen, features.diffuse_clipped], axis=-1)
    beside = np.concatenate(
        [count[:, None] / np.float32(features.is_seen.shape[1]), features.normals, known],
        axis=-1,
    ).astype(np.float32)
    mean_light = features.diffuse_light.mean(axis=0)
    return np.concatenate(
        [
            _log(features.diffuse_light / mean_light)[..., None],
            np.broadcast_to(beside[:, None], (voxels, 3, beside.shape[-1])),
            features.voxel_fit.reshape(voxels, 3, -1),
        ],
        axis=-1,
    )


class _Standard(NamedTuple):
    """Inputs in standard units; see :class:`reflest_core.models.lightnet.network.Standard`."""

    mean: Array
    deviation: Array

    @staticmethod
    def of(tensors: Tensors, name: str) -> _Standard:
        deviation = np.sqrt(tensors[f"{name}.variance"] + np.float32(1e-4))
        return _Standard(tensors[f"{name}.mean"], deviation)

    def scores(self, values: Array) -> Array:
        return np.asarray(np.clip((values - self.mean) / self.deviation, -FURTHEST, FURTHEST))


def _answer(head: Array, found: Array) -> tuple[Array, Array]:
    """Mean and log variance, (N,) each; see ``models/lightnet/network.py``."""
    weights = np.exp(head[:, 2:] - head[:, 2:].max(axis=1, keepdims=True))
    weights /= weights.sum(axis=1, keepdims=True)
    return head[:, 0] + (weights[:, :-1] * found).sum(axis=1), head[:, 1]


def _two_layers(tensors: Tensors, name: str) -> tuple[DenseLayer, DenseLayer]:
    return DenseLayer.of(tensors, f"{name}.0"), DenseLayer.of(tensors, f"{name}.2")


def _run(layers: tuple[DenseLayer, ...], values: Array) -> Array:
    flat = values.reshape(-1, values.shape[-1])  # one product, not one for each of the first axis
    for layer in layers:
        flat = layer.linear(flat)
        flat /= np.float32(1.0) + np.exp(-flat)  # SiLU
    return flat.reshape(*values.shape[:-1], -1)


def _log(ratio: Array) -> Array:
    return np.asarray(np.log(ratio + FLOOR), np.float32)
