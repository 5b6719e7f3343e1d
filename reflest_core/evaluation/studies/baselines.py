# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The networks' rivals on the same scenes, each with its run time."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from tqdm import tqdm

from reflest_core.estimation.estimator import physical_ward
from reflest_core.evaluation.contenders import Contender
from reflest_core.evaluation.paper_figures import OPTIMISER_SECONDS
from reflest_core.evaluation.shown_scenes import random_subset
from reflest_core.evaluation.statistics.accuracy import Statistics, accuracy
from reflest_core.evaluation.studies.simple_baselines import guess_mean, lambertian
from reflest_core.evaluation.studies.single_image import optimise_single_image
from reflest_core.training.data.sample import Sample

SUBSET_SEED = 17

Estimate = Callable[[Sample], object]


def measure_baselines(
    contenders: list[Contender], splits: dict[str, list[Sample]], optimised_scenes: int
) -> dict[str, Any]:
    """Accuracy and seconds a scene on each split; the optimiser on a subset drawn by seed.

    The networks and the cheap rivals are measured on that subset too, so that rows compare.
    """
    statistics = contenders[0].predictor().card.statistics
    ward = statistics["ward"]
    rivals: list[tuple[str, Estimate, float | None]] = [
        ("guessing the mean", lambda sample: guess_mean(ward), None),
        ("Lambertian from F and B", lambda sample: lambertian(sample.surface, ward), None),
    ]
    for contender in contenders:
        rivals.append((contender.title, _network(contender), None))
    optimiser = (
        "one image, optimised",
        lambda sample: optimise_single_image(sample.surface, ward),
        OPTIMISER_SECONDS,
    )
    rows = []
    for split, samples in splits.items():
        subset = random_subset(samples, optimised_scenes, SUBSET_SEED)
        for name, estimate, seconds in [*rivals, optimiser]:
            rows.append(_row(name, split, estimate, subset, statistics, seconds))
        for name, estimate, seconds in rivals[:2]:
            rows.append(_row(name, split, estimate, samples, statistics, seconds))
    return {"subset": optimised_scenes, "rows": rows}


def _network(contender: Contender) -> Estimate:
    predictor = contender.predictor()
    return lambda sample: physical_ward(predictor.predict(sample.surface).ward)


def _row(
    name: str,
    split: str,
    estimate: Estimate,
    samples: list[Sample],
    statistics: Statistics,
    paper_seconds: float | None,
) -> dict[str, Any]:
    made, times = [], []
    for sample in tqdm(samples, desc=f"{name} on {split}", unit="scene", leave=False):
        started = time.perf_counter()
        made.append(np.asarray(estimate(sample)))
        times.append(time.perf_counter() - started)
    measured = accuracy(np.stack(made), samples, statistics)
    return {
        "name": name,
        "split": split,
        "accuracy": dataclasses.asdict(measured),
        "median_seconds": float(np.median(times)),
        "paper_seconds": paper_seconds,
    }
