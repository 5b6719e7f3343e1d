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
from reflest_core.inference.material import Explanation
from reflest_core.light.light_knowledge import LightKnowledge, light_knowledge
from reflest_core.models.grouplet import live as live_grouplet
from reflest_core.models.hemicnn import live as live_hemicnn
from reflest_core.models.lightnet import live as live_lightnet
from reflest_core.models.lightnet import shapes as lightnet_shapes
from reflest_core.models.model_choice import MODELS
from reflest_core.models.quantisation import Tensors
from reflest_core.models.scores import Scores
from reflest_core.models.threads import one_blas_thread
from reflest_core.models.torch_network import TorchNetwork
from reflest_core.models.weights import SHIPPED, WeightsError, check_fits, load_weights
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.voxel_choice import choose_voxels

SHAPES = {
    "hemicnn": live_hemicnn.SHAPES,
    "grouplet": live_grouplet.SHAPES,
    "lightnet": lightnet_shapes.SHAPES,
}
LARGEST_LOG_VARIANCE = 3.0
"""Of a z-score; training tells variances apart up to here."""


class LiveNetwork(Protocol):
    """A trained network together with the building of its features."""

    def scores(
        self,
        surface: ObservedSurface,
        voxels: NDArray[np.int64],
        found: Explanation | None = None,
    ) -> Scores:
        """Estimate the z-scored parameters of a surface.

        Args:
            surface: a scan, or a material's part of one.
            voxels: (N,) indices of the voxels that the estimate rests on, all observed.
            found: the material in the light of its scene, for networks that see light; None takes
                the surface for a scene of one material.
        """


@dataclass(frozen=True)
class Prediction:
    """``ward``: (5,) float64 ``rho_d`` (3), ``rho_s``, ``alpha``, not clipped to physical values.

    ``voxels``: (N,) indices of the voxels that they rest on. ``stddev``: (5,) float64, one standard
    deviation of each Ward parameter; None from the paper's networks, which know none.
    ``light``: how much was known of the light; None where the network does not look at it.
    """

    ward: NDArray[np.float64]
    voxels: NDArray[np.int64]
    stddev: NDArray[np.float64] | None = None
    light: LightKnowledge | None = None


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
        self.voxels, self._sees_light = choice.voxels, choice.sees_light
        self.model_id = f"{model}/{digest[:12]}"

    @property
    def sees_light(self) -> bool:
        """Whether the network estimates from the light around the surface too."""
        return self._sees_light

    def predict(self, surface: ObservedSurface, found: Explanation | None = None) -> Prediction:
        """Estimate from the surface's chosen voxels.

        Args:
            surface: at least one voxel was observed.
            found: see :meth:`LiveNetwork.scores`.
        """
        with one_blas_thread():
            return self._predict(surface, found)

    def _predict(self, surface: ObservedSurface, found: Explanation | None) -> Prediction:
        voxels = choose_voxels(surface, self.voxels)
        scores = self.network.scores(surface, voxels, found)
        values = self.card.output_statistics.restore(scores.means.astype(np.float64))
        ward = labcd_to_ward(values) if self.card.parameters == "labcd" else values
        if not self._sees_light:
            return Prediction(ward, voxels)
        light = light_knowledge(surface.light, surface.normals[voxels])
        return Prediction(ward, voxels, self._deviations(scores, light), light)

    def _deviations(self, scores: Scores, light: LightKnowledge) -> NDArray[np.float64] | None:
        """Standard deviations (5,) of the Ward parameters, calibrated.

        Where nothing was seen of the light they are at least those of the materials at large.
        """
        if scores.log_variances is None:
            return None
        usual = self.card.statistics["ward"].stddev
        log_variances = np.minimum(scores.log_variances.astype(np.float64), LARGEST_LOG_VARIANCE)
        stddev = self.card.calibration.calibrated(np.exp(0.5 * log_variances)) * usual
        return np.maximum(stddev, usual) if light.seen == 0.0 else stddev


def _live_network(network: str, tensors: Tensors, device: str, threads: int) -> LiveNetwork:
    if device != "cpu":
        return TorchNetwork(network, tensors, device)
    if network == "hemicnn":
        return live_hemicnn.LiveHemiCNN(tensors)
    if network == "lightnet":
        return live_lightnet.LiveLightNet(tensors)
    return live_grouplet.LiveGrouplet(tensors, threads)
