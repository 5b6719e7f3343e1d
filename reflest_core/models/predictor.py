"""From an observed surface to five parameters: features, network, z-score, one object."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.brdf.gloss import labcd_to_ward
from reflest_core.features.voxel_choice import choose_voxels
from reflest_core.fusion.observed_surface import ObservedSurface
from reflest_core.models.grouplet import FAST_VOXELS, SLOW_VOXELS
from reflest_core.models.hemicnn import VOXELS
from reflest_core.models.network_kind import NETWORKS, FeatureDraw
from reflest_core.models.weights import SHIPPED, WeightsError, load_into, load_weights

FIXED_DRAW = FeatureDraw(seed=0)
"""Grouplets are drawn at random but always alike, so that an estimate repeats bit for bit."""


@dataclass(frozen=True)
class ModelChoice:
    """One way to estimate: which network, how many voxels, which shipped weights."""

    network: str
    voxels: int
    file: str


MODELS = {
    "hemicnn": ModelChoice("hemicnn", VOXELS, "hemicnn.safetensors"),
    "grouplet-fast": ModelChoice("grouplet", FAST_VOXELS, "grouplet.safetensors"),
    "grouplet-slow": ModelChoice("grouplet", SLOW_VOXELS, "grouplet.safetensors"),
}


@dataclass(frozen=True)
class Prediction:
    """``ward``: (5,) float64 ``rho_d`` (3), ``rho_s``, ``alpha``, not clipped to physical values.

    ``voxels``: (N,) indices of the voxels that they rest on.
    """

    ward: NDArray[np.float64]
    voxels: NDArray[np.int64]


class Predictor:
    """A trained network ready to look at surfaces, from one thread at a time."""

    def __init__(self, model: str, weights: Path | None = None) -> None:
        """Load ``model`` (a key of :data:`MODELS`) from its shipped weights or a file."""
        choice = MODELS[model]
        path = weights or SHIPPED / choice.file
        tensors, self.card, digest = load_weights(path)
        if self.card.network != choice.network:
            raise WeightsError(
                f"{path} holds a {self.card.network} network; set the model to one that uses it, "
                f"not {model}"
            )
        self.kind = NETWORKS[choice.network]
        self.module = self.kind.make()
        load_into(self.module, tensors, path)
        self.module.eval()
        self.voxels = choice.voxels
        self.model_id = f"{model}/{digest[:12]}"

    def predict(self, surface: ObservedSurface) -> Prediction:
        """Estimate from the surface's chosen voxels; it needs at least one observed voxel."""
        voxels = choose_voxels(surface, self.voxels)
        with torch.inference_mode():
            inputs = self.kind.features(surface, voxels, FIXED_DRAW)
            scores = self.module(*(tensor[None] for tensor in inputs))[0]
        values = self.card.output_statistics.restore(scores.double().numpy())
        ward = labcd_to_ward(values) if self.card.parameters == "labcd" else values
        return Prediction(ward, voxels)
