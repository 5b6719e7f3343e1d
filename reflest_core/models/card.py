# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a network's outputs mean and how it came to be: the card that every weight file carries."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.parameters import PARAMETERS, WardVariant

WARD_NAMES = PARAMETERS
LABCD_NAMES = ("L", "a", "b", "c", "d")


@dataclass(frozen=True)
class ParameterStatistics:
    """The training set's statistics, by which parameters are z-scored.

    Attributes:
        mean: (5,) float64, in the order of :data:`WARD_NAMES` or :data:`LABCD_NAMES`.
        stddev: (5,) float64.
    """

    mean: NDArray[np.float64]
    stddev: NDArray[np.float64]

    @staticmethod
    def of(parameters: NDArray[np.float64]) -> ParameterStatistics:
        """Compute the statistics of (S, 5) parameters.

        Args:
            parameters: (S, 5) parameters.
        """
        return ParameterStatistics(parameters.mean(axis=0), parameters.std(axis=0))

    def normalise(self, parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        """Z-score parameters (..., 5).

        Args:
            parameters: (S, 5) parameters.
        """
        scores: NDArray[np.float64] = (parameters - self.mean) / self.stddev
        return scores

    def restore(self, scores: NDArray[np.float64]) -> NDArray[np.float64]:
        """Undo :meth:`normalise` for z-scores (..., 5).

        Args:
            scores: (..., 5) z-scores.
        """
        parameters: NDArray[np.float64] = scores * self.stddev + self.mean
        return parameters


@dataclass(frozen=True)
class Calibration:
    """Power laws that turn the deviations that a network states into those of its errors.

    Powers above 1 say that the network's deviations are too large where they are small, and too
    small where they are large.

    Attributes:
        factors: (5,), one for each Ward parameter, of the deviation to its power.
        powers: (5,).
        correlation: (5, 5), of errors divided by calibrated deviations.
    """

    factors: NDArray[np.float64] = field(default_factory=lambda: np.ones(5))
    powers: NDArray[np.float64] = field(default_factory=lambda: np.ones(5))
    correlation: NDArray[np.float64] = field(default_factory=lambda: np.eye(5))

    def calibrated(self, deviations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Calibrate deviations (..., 5) of z-scored Ward parameters.

        Args:
            deviations: (..., 5), of z-scored Ward parameters as a network states them.
        """
        calibrated: NDArray[np.float64] = self.factors * deviations**self.powers
        return calibrated


@dataclass(frozen=True)
class WeightsCard:
    """What a weight file says of its network.

    Attributes:
        network: Name of the network's :class:`~reflest_core.models.definition.NetworkDefinition`.
        parameters: ``ward`` or ``labcd``, the meaning of the five outputs after their z-score is
            undone.
        variant: The variant of Ward's model that the outputs are for.
        statistics: The training set's, for both parameterisations.
        recipe: Data, loss, optimiser, seed.
        calibration: Of the standard deviations, fitted on environments that training never saw.
    """

    network: str
    parameters: str
    variant: WardVariant
    statistics: dict[str, ParameterStatistics]
    recipe: dict[str, Any]
    calibration: Calibration = field(default_factory=Calibration)

    @property
    def output_statistics(self) -> ParameterStatistics:
        """The statistics by which the network's outputs are z-scored."""
        return self.statistics[self.parameters]

    def to_json(self) -> str:
        """The card as it is stored in a weight file."""
        return json.dumps(
            {
                "network": self.network,
                "parameters": self.parameters,
                "variant": self.variant.value,
                "statistics": {
                    name: {"mean": known.mean.tolist(), "stddev": known.stddev.tolist()}
                    for name, known in self.statistics.items()
                },
                "recipe": self.recipe,
                "stddev_factors": self.calibration.factors.tolist(),
                "stddev_powers": self.calibration.powers.tolist(),
                "error_correlation": self.calibration.correlation.tolist(),
            },
            sort_keys=True,
        )

    @staticmethod
    def from_json(described: str) -> WeightsCard:
        """Read :meth:`to_json`'s string.

        Args:
            described: The stored string.
        """
        card = json.loads(described)
        statistics = {
            name: ParameterStatistics(np.array(known["mean"]), np.array(known["stddev"]))
            for name, known in card["statistics"].items()
        }
        return WeightsCard(
            card["network"],
            card["parameters"],
            WardVariant(card["variant"]),
            statistics,
            card["recipe"],
            Calibration(
                np.array(card.get("stddev_factors", np.ones(5))),
                np.array(card.get("stddev_powers", np.ones(5))),
                np.array(card.get("error_correlation", np.eye(5))),
            ),
        )
