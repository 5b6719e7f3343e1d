# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""From an observed surface to five parameters: voxel choice, features, network, z-scores undone."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.gloss import labcd_to_ward
from reflest_core.inference.material import Explanation
from reflest_core.light.light_knowledge import LightKnowledge, light_knowledge
from reflest_core.models.definition import LiveNetwork, Scores
from reflest_core.models.linear_algebra import one_blas_thread
from reflest_core.models.registry import network_of_model
from reflest_core.models.torch_network import TorchNetwork
from reflest_core.models.weights import WeightsError, check_fits, load_weights
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.voxel_choice import choose_voxels

CHOICES = 2
"""Disjoint choices of voxels of one explained material: the mean of their scores moves less when
what should not matter changes."""
LARGEST_LOG_VARIANCE = 3.0
"""Of a z-score; training distinguishes variances up to here."""


@dataclass(frozen=True)
class Prediction:
    """A network's estimate of one surface.

    Attributes:
        ward: (5,) float64 ``rho_d`` (3), ``rho_s``, ``alpha``, not clipped to physical values.
        voxels: (N,) indices of the voxels that the estimate rests on.
        stddev: (5,) float64, one standard deviation of each Ward parameter; None where the network
            states none.
        light: How much was known of the light; None where the network does not use it.
        has_posterior: Whether the network was trained to use the posterior of roughness, so that it
            must not be joined with it again.
    """

    ward: NDArray[np.float64]
    voxels: NDArray[np.int64]
    stddev: NDArray[np.float64] | None = None
    light: LightKnowledge | None = None
    has_posterior: bool = False


class Predictor:
    """A trained network that estimates surfaces; to be used by one thread at a time.

    Attributes:
        card: The card of its weights.
        network: Its live form.
        voxels: N, voxels that it chooses of a surface.
        sees_light: Whether the network uses the light around the surface.
        model_id: Name of the model and the first digits of its weights' hash.
    """

    def __init__(
        self, model: str, weights: Path | None = None, device: str = "cpu", threads: int = 1
    ) -> None:
        """Load a model.

        Args:
            model: Name of a registered model.
            weights: Weight file; None takes the shipped one.
            device: ``cpu`` (the network's live form) or ``cuda`` (PyTorch).
            threads: CPU threads of the live form.

        Raises:
            RegistryError: There is no such model.
            WeightsError: The weights are missing, damaged or of another network.
            DeviceError: The device cannot be used.
        """
        definition = network_of_model(model)
        choice = definition.model_named(model)
        path = weights or choice.weights
        if path is None:
            raise WeightsError(f"{model} comes without weights; set estimation.weights to a file")
        tensors, self.card, digest = load_weights(path)
        if self.card.network != definition.name:
            raise WeightsError(
                f"{path} holds a {self.card.network} network; set the model to one that uses it, "
                f"not {model}"
            )
        tensors = definition.completed(tensors)
        check_fits(tensors, definition.shapes(), path)
        self.network: LiveNetwork
        if device == "cpu":
            self.network = definition.live(tensors, threads)
        else:
            self.network = TorchNetwork(definition, tensors, device)
        self.voxels, self.sees_light = choice.voxels, definition.sees_light
        self.model_id = f"{model}/{digest[:12]}"

    def predict(self, surface: ObservedSurface, found: Explanation | None = None) -> Prediction:
        """Estimate from the surface's chosen voxels.

        Args:
            surface: Upright (+z is up), with at least one observed voxel.
            found: See :meth:`~reflest_core.models.definition.LiveNetwork.scores`.

        Raises:
            WeightsError: The network's outputs are not finite.
        """
        with one_blas_thread():
            return self._predict(surface, found)

    def _predict(self, surface: ObservedSurface, found: Explanation | None) -> Prediction:
        voxels = self.chosen(surface)
        scores = self._scores(surface, voxels, found)
        stated = (
            scores.means if scores.log_variances is None else (*scores.means, *scores.log_variances)
        )
        if not np.isfinite(stated).all():
            raise WeightsError(
                f"{self.model_id} gives numbers that are not finite: its weights cannot be used; "
                "correct estimation.weights"
            )
        values = self.card.output_statistics.restore(scores.means.astype(np.float64))
        ward = labcd_to_ward(values) if self.card.parameters == "labcd" else values
        light = None
        if self.sees_light:
            light = light_knowledge(surface.light, surface.normals[voxels])
        has_posterior = bool(self.card.recipe.get("gloss_posterior", False))
        return Prediction(ward, voxels, self._deviations(scores, light), light, has_posterior)

    def chosen(self, surface: ObservedSurface) -> NDArray[np.int64]:
        """Choose the voxels of a surface that an estimate rests on.

        Args:
            surface: Upright (+z is up), with at least one observed voxel.

        Returns:
            At most :attr:`voxels` indices, or :data:`CHOICES` times as many for a network that uses
            the light, rising.
        """
        return choose_voxels(surface, self.voxels * (CHOICES if self.sees_light else 1))

    def _scores(
        self, surface: ObservedSurface, voxels: NDArray[np.int64], found: Explanation | None
    ) -> Scores:
        """The mean scores of as many disjoint choices as there are voxels for."""
        scores = self.network.scores(surface, dealt(voxels, self.voxels), found)
        if len(scores) == 1:
            return scores[0]
        means = np.mean([one.means for one in scores], axis=0)
        known = [one.log_variances for one in scores if one.log_variances is not None]
        return Scores(means, np.mean(known, axis=0) if known else None)

    def _deviations(
        self, scores: Scores, light: LightKnowledge | None
    ) -> NDArray[np.float64] | None:
        """Calibrated standard deviations (5,) of the Ward parameters.

        Where a network that uses the light saw none, they are at least those of all materials.
        """
        if scores.log_variances is None:
            return None
        usual = self.card.statistics["ward"].stddev
        log_variances = np.minimum(scores.log_variances.astype(np.float64), LARGEST_LOG_VARIANCE)
        stddev = self.card.calibration.calibrated(np.exp(0.5 * log_variances)) * usual
        is_blind = light is not None and light.seen == 0.0
        return np.maximum(stddev, usual) if is_blind else stddev


def dealt(voxels: NDArray[np.int64], size: int) -> list[NDArray[np.int64]]:
    """Deal chosen voxels out into as many disjoint choices as there are enough for.

    Args:
        voxels: (N,) indices of chosen voxels, rising.
        size: Fewest voxels of each choice where there are several.

    Returns:
        Choices that are spread alike, at least one.
    """
    choices = max(len(voxels) // size, 1)
    return [voxels[first::choices] for first in range(choices)]
