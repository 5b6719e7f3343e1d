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
        """Compute the statistics of a training set.

        Args:
            parameters: (S, 5) parameters.
        """
        return ParameterStatistics(parameters.mean(axis=0), parameters.std(axis=0))

    def normalise(self, parameters: NDArray[np.float64]) -> NDArray[np.float64]:
        """Z-score parameters.

        Args:
            parameters: (..., 5) parameters.
        """
        scores: NDArray[np.float64] = (parameters - self.mean) / self.stddev
        return scores

    def restore(self, scores: NDArray[np.float64]) -> NDArray[np.float64]:
        """Undo :meth:`normalise`.

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

    factors: NDArray[np.float64] = field(default_factory=lambda: np.ones(len(WARD_NAMES)))
    powers: NDArray[np.float64] = field(default_factory=lambda: np.ones(len(WARD_NAMES)))
    correlation: NDArray[np.float64] = field(default_factory=lambda: np.eye(len(WARD_NAMES)))

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

        Raises:
            ValueError: It is no card: not JSON, or a field is missing or out of its range.
        """
        try:
            card = json.loads(described)
            parameters = card["parameters"]
            if parameters not in ("ward", "labcd"):
                raise ValueError(f"parameters is {parameters!r:.40}, not ward or labcd")
            return WeightsCard(
                str(card["network"]),
                parameters,
                WardVariant(card["variant"]),
                {name: _statistics(card["statistics"][name]) for name in ("ward", "labcd")},
                dict(card["recipe"]),
                _calibration(card),
            )
        except KeyError as error:
            raise ValueError(f"it has no field {error}") from error
        except (TypeError, AttributeError, RecursionError) as error:
            raise ValueError(f"{error}") from error


def _statistics(known: dict[str, Any]) -> ParameterStatistics:
    size = (len(WARD_NAMES),)
    mean = _numbers("statistics mean", known["mean"], size)
    stddev = _numbers("statistics stddev", known["stddev"], size)
    if not (stddev > 0.0).all():
        raise ValueError("a stddev of the statistics is not above 0")
    return ParameterStatistics(mean, stddev)


def _calibration(card: dict[str, Any]) -> Calibration:
    size = len(WARD_NAMES)
    factors = _numbers("stddev_factors", card.get("stddev_factors", [1.0] * size), (size,))
    powers = _numbers("stddev_powers", card.get("stddev_powers", [1.0] * size), (size,))
    correlation = card.get("error_correlation", np.eye(size))
    correlation = _numbers("error_correlation", correlation, (size, size))
    if not ((factors > 0.0).all() and (powers > 0.0).all()):
        raise ValueError("stddev_factors and stddev_powers must be above 0")
    if np.abs(correlation).max() > 1.0 + 1e-6:
        raise ValueError("error_correlation must lie within -1 and 1")
    return Calibration(factors, powers, correlation)


def _numbers(name: str, values: Any, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Finite numbers of a shape, or ValueError."""
    numbers = np.array(values, np.float64)
    if numbers.shape != shape or not np.isfinite(numbers).all():
        raise ValueError(f"{name} must be {' x '.join(map(str, shape))} finite numbers")
    return numbers
