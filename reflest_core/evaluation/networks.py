# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The trained networks that are evaluated: the paper's variants that have weights, and lightnet."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from reflest_core.errors import ReflestError
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.models.predictor import Predictor
from reflest_core.models.registry import network_of_model, networks
from reflest_core.training.variants import VARIANTS

LIGHTNET = "lightnet"


class EvaluationError(ReflestError):
    """There is nothing to evaluate, or what an evaluation needs is missing."""


@dataclass(frozen=True)
class EvaluatedNetwork:
    """A network with weights, as one row of the tables.

    Attributes:
        name: The variant of Table 2, or the name of a network that Table 2 does not have.
        title: The name in tables and plots.
        model: The registered model that the network estimates as.
        weights: The weight file.
        exact: The same weights in float32, or None where they were not kept.
    """

    name: str
    title: str
    model: str
    weights: Path
    exact: Path | None = None

    @property
    def architecture(self) -> str:
        """The name of the network's architecture."""
        return network_of_model(self.model).name

    def predictor(self) -> Predictor:
        """Load the weights; the predictor runs on one thread."""
        return Predictor(self.model, self.weights)

    def estimator(self) -> Estimator:
        """Load the live path after the store; it runs on one thread and accepts a single voxel."""
        return Estimator(
            EstimationSettings(model=self.model, weights=str(self.weights), min_voxels=1)
        )

    def as_fast(self) -> EvaluatedNetwork:
        """The same weights at Grouplet-fast's 20 voxels."""
        return dataclasses.replace(self, model="grouplet-fast")


def find_networks(runs: Path | None) -> list[EvaluatedNetwork]:
    """Find the networks to compare.

    Args:
        runs: A folder of trainings (``runs/<variant>/``), or None for the shipped weights.

    Returns:
        The variants of Table 2 that have weights, then every other registered network: from
        ``runs/<network>/`` if it is there, else as shipped.

    Raises:
        EvaluationError: ``runs`` holds no weights.
    """
    found = []
    for variant in VARIANTS:
        weights = variant.shipped if runs is None else runs / variant.name / variant.file_name
        if weights.is_file():
            exact = weights.with_name(f"{variant.name}-float32.safetensors")
            kept = exact if exact.is_file() else None
            found.append(
                EvaluatedNetwork(variant.name, variant.title, variant.model, weights, kept)
            )
    others = _other_networks(runs)
    if not found and not any(runs is None or runs in one.weights.parents for one in others):
        place = "this installation" if runs is None else runs
        raise EvaluationError(
            f"{place} holds no weights of a variant of Table 2 or another network; train one with "
            "'reflest train DATA --variant NAME --out RUNS/NAME' and give --runs RUNS"
        )
    return found + others


def _other_networks(runs: Path | None) -> list[EvaluatedNetwork]:
    """Registered networks that no variant of Table 2 uses, where they have weights."""
    found = []
    for network in networks().values():
        if any(variant.network == network.name for variant in VARIANTS):
            continue
        model = network.models[0]
        trained = [] if runs is None else [runs / network.name / f"{network.name}.safetensors"]
        shipped = [] if model.weights is None else [model.weights]
        weights = next((path for path in [*trained, *shipped] if path.is_file()), None)
        if weights is not None:
            found.append(EvaluatedNetwork(network.name, network.name, model.name, weights))
    return found


def network_named(networks: list[EvaluatedNetwork], name: str) -> EvaluatedNetwork | None:
    """The network of that name, or None where it has no weights.

    Args:
        networks: The networks that have weights.
        name: A variant of Table 2, or ``lightnet``.
    """
    return next((network for network in networks if network.name == name), None)


def require_lightnet(networks: list[EvaluatedNetwork]) -> EvaluatedNetwork:
    """Return lightnet among ``networks``.

    Args:
        networks: those to compare.

    Raises:
        EvaluationError: it has no weights.
    """
    network = network_named(networks, LIGHTNET)
    if network is None:
        raise EvaluationError(
            "there are no weights of lightnet; train them with 'reflest train DATA --model "
            "lightnet --out RUNS/lightnet' and give --runs RUNS"
        )
    return network
