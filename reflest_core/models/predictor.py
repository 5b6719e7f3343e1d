# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""From an observed surface to five parameters: features, network, z-score, one object."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.gloss import labcd_to_ward
from reflest_core.features.voxel_choice import choose_voxels
from reflest_core.fusion.observed_surface import ObservedSurface
from reflest_core.models import live_grouplet, live_hemicnn
from reflest_core.models.model_choice import MODELS
from reflest_core.models.quantisation import Tensors
from reflest_core.models.torch_network import TorchNetwork
from reflest_core.models.weights import SHIPPED, WeightsError, check_fits, load_weights

SHAPES = {"hemicnn": live_hemicnn.SHAPES, "grouplet": live_grouplet.SHAPES}


class LiveNetwork(Protocol):
    """A trained network together with the building of its features."""

    def scores(self, surface: ObservedSurface, voxels: NDArray[np.int64]) -> NDArray[np.float32]:
        """(5,) z-scored parameters of the surface, from its ``voxels`` (N,), all observed."""


@dataclass(frozen=True)
class Prediction:
    """``ward``: (5,) float64 ``rho_d`` (3), ``rho_s``, ``alpha``, not clipped to physical values.

    ``voxels``: (N,) indices of the voxels that they rest on.
    """

    ward: NDArray[np.float64]
    voxels: NDArray[np.int64]


class Predictor:
    """A trained network ready to look at surfaces, from one thread at a time."""

    def __init__(
        self, model: str, weights: Path | None = None, device: str = "cpu", threads: int = 1
    ) -> None:
        """Load ``model`` (a key of :data:`MODELS`) from its shipped weights or a file.

        ``device``: ``cpu`` (NumPy, at most ``threads`` threads) or ``cuda`` (PyTorch). Raises
        :class:`WeightsError` or :class:`DeviceError`.
        """
        choice = MODELS[model]
        path = weights or SHIPPED / choice.file
        tensors, self.card, digest = load_weights(path)
        if self.card.network != choice.network:
            raise WeightsError(
                f"{path} holds a {self.card.network} network; set the model to one that uses it, "
                f"not {model}"
            )
        check_fits(tensors, SHAPES[choice.network], path)
        self.network = _live_network(choice.network, tensors, device, threads)
        self.voxels = choice.voxels
        self.model_id = f"{model}/{digest[:12]}"

    def predict(self, surface: ObservedSurface) -> Prediction:
        """Estimate from the surface's chosen voxels; it needs at least one observed voxel."""
        voxels = choose_voxels(surface, self.voxels)
        scores = self.network.scores(surface, voxels)
        values = self.card.output_statistics.restore(scores.astype(np.float64))
        ward = labcd_to_ward(values) if self.card.parameters == "labcd" else values
        return Prediction(ward, voxels)


def _live_network(network: str, tensors: Tensors, device: str, threads: int) -> LiveNetwork:
    if device != "cpu":
        return TorchNetwork(network, tensors, device)
    if network == "hemicnn":
        return live_hemicnn.LiveHemiCNN(tensors)
    return live_grouplet.LiveGrouplet(tensors, threads)
