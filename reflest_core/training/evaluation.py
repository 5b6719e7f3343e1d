"""What a shipped model reaches on a split: the figures of Tables 2 and 3."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.estimation.estimator import physical_ward
from reflest_core.models.predictor import Predictor
from reflest_core.training.metrics import NormalisedRmse, normalised_rmse
from reflest_core.training.sample import Sample


@dataclass(frozen=True)
class Evaluation:
    """One row of the table: a model on a split, in both parameterisations.

    ``estimates``, ``truths``: (S, 5) float64 Ward parameters of the split's scenes.
    """

    model: str
    split: str
    ward: NormalisedRmse
    labcd: NormalisedRmse
    estimates: NDArray[np.float64]
    truths: NDArray[np.float64]


def evaluate(
    predictor: Predictor,
    samples: list[Sample],
    split: str,
    progress: Callable[[], object],
    name: str | None = None,
) -> Evaluation:
    """Estimate every scene as the live path would; ``progress`` is called after each.

    The row is named ``name``, or by the model and its weights.
    """
    estimates = []
    for sample in samples:
        estimates.append(physical_ward(predictor.predict(sample.surface).ward))
        progress()
    return _measure(predictor, np.stack(estimates), samples, split, name or predictor.model_id)


def guess_the_mean(predictor: Predictor, samples: list[Sample], split: str) -> Evaluation:
    """The baseline: the training set's mean, whatever is seen."""
    guess = predictor.card.statistics["ward"].mean
    return _measure(
        predictor, np.tile(guess, (len(samples), 1)), samples, split, "guessing the mean"
    )


def _measure(
    predictor: Predictor,
    estimates: NDArray[np.float64],
    samples: list[Sample],
    split: str,
    model: str,
) -> Evaluation:
    truths = np.stack([sample.ward for sample in samples])
    known = predictor.card.statistics
    return Evaluation(
        model,
        split,
        normalised_rmse(estimates, truths, known["ward"]),
        normalised_rmse(ward_to_labcd(estimates), ward_to_labcd(truths), known["labcd"]),
        estimates,
        truths,
    )
