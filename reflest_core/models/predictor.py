"""From an observed surface to five parameters: features, network, z-score, one object."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.features.grouplets import draw_grouplets
from reflest_core.features.hemisphere import hemisphere_images
from reflest_core.features.voxel_choice import choose_voxels
from reflest_core.fusion.observed_surface import ObservedSurface
from reflest_core.models.grouplet import FAST_VOXELS, SLOW_VOXELS, Grouplet
from reflest_core.models.hemicnn import VOXELS, HemiCNN
from reflest_core.models.weights import SHIPPED, WeightsError, load_into, load_weights

GROUPLET_SEED = 0
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


class SurfaceNetwork(Protocol):
    """A network with the features that it eats."""

    @property
    def module(self) -> torch.nn.Module:
        """The trained part."""

    def scores(self, surface: ObservedSurface, voxels: NDArray[np.int64]) -> torch.Tensor:
        """(5,) z-scores of the surface, seen at ``voxels`` (N,)."""


class HemiCNNOnSurface:
    """HemiCNN with hemisphere images."""

    def __init__(self) -> None:
        self.module = HemiCNN()

    def scores(self, surface: ObservedSurface, voxels: NDArray[np.int64]) -> torch.Tensor:
        """(5,) z-scores."""
        images = torch.from_numpy(hemisphere_images(surface, voxels))
        scores: torch.Tensor = self.module(images[None])[0]
        return scores


class GroupletOnSurface:
    """Grouplet with ten nodes of each voxel."""

    def __init__(self) -> None:
        self.module = Grouplet()

    def scores(self, surface: ObservedSurface, voxels: NDArray[np.int64]) -> torch.Tensor:
        """(5,) z-scores."""
        drawn = draw_grouplets(surface, voxels, GROUPLET_SEED)
        branches, normals = torch.from_numpy(drawn.branches), torch.from_numpy(drawn.normals)
        scores: torch.Tensor = self.module(branches[None], normals[None])[0]
        return scores


NETWORKS: dict[str, Callable[[], SurfaceNetwork]] = {
    "hemicnn": HemiCNNOnSurface,
    "grouplet": GroupletOnSurface,
}


@dataclass(frozen=True)
class Prediction:
    """``values`` (5,) float64 in the card's parameters; ``voxels`` (N,) that they rest on."""

    values: NDArray[np.float64]
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
        self.network: SurfaceNetwork = NETWORKS[choice.network]()
        load_into(self.network.module, tensors, path)
        self.network.module.eval()
        self.voxels = choice.voxels
        self.model_id = f"{model}/{digest[:12]}"

    def predict(self, surface: ObservedSurface) -> Prediction:
        """Estimate from the surface's chosen voxels; it needs at least one observed voxel."""
        voxels = choose_voxels(surface, self.voxels)
        with torch.inference_mode():
            scores = self.network.scores(surface, voxels)
        values = self.card.statistics.restore(scores.double().numpy())
        return Prediction(values, voxels)
