# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Baselines on the same scenes as the networks, each with its run time."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from reflest_core.brdf import srgb
from reflest_core.brdf.parameters import ALPHA
from reflest_core.estimation.physical_ward import physical_ward
from reflest_core.evaluation.networks import EvaluatedNetwork
from reflest_core.evaluation.paper_figures import OPTIMISER_SECONDS
from reflest_core.evaluation.shown_scenes import random_subset
from reflest_core.evaluation.statistics.accuracy import Statistics, accuracy
from reflest_core.evaluation.studies.single_image import optimise_single_image
from reflest_core.models.card import ParameterStatistics
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.training.data.sample import Sample

SUBSET_SEED = 17

Estimate = Callable[[Sample], object]


def measure_baselines(
    networks: list[EvaluatedNetwork], splits: dict[str, list[Sample]], optimised_scenes: int
) -> dict[str, Any]:
    """Accuracy and seconds a scene of networks and baselines on each split.

    All methods run on the same random subset; the cheap baselines also run on the whole split.

    Args:
        networks: The networks to compare.
        splits: The scenes of each split.
        optimised_scenes: Size of the subset, for the slow optimiser.

    Returns:
        The record of the part ``baselines``.
    """
    statistics = networks[0].predictor().card.statistics
    ward = statistics["ward"]
    methods: list[tuple[str, Estimate, float | None]] = [
        ("guessing the mean", lambda sample: guess_mean(ward), None),
        ("Lambertian from F and B", lambda sample: lambertian(sample.surface, ward), None),
    ]
    for network in networks:
        methods.append((network.title, _network(network), None))
    optimiser = (
        "one image, optimised",
        lambda sample: optimise_single_image(sample.surface, ward),
        OPTIMISER_SECONDS,
    )
    rows = []
    for split, samples in splits.items():
        subset = random_subset(samples, optimised_scenes, SUBSET_SEED)
        for name, estimate, seconds in [*methods, optimiser]:
            rows.append(_row(name, split, estimate, subset, statistics, seconds))
        for name, estimate, seconds in methods[:2]:
            rows.append(_row(name, split, estimate, samples, statistics, seconds))
    return {"subset": optimised_scenes, "rows": rows}


def _network(network: EvaluatedNetwork) -> Estimate:
    predictor = network.predictor()
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


def guess_mean(statistics: ParameterStatistics) -> NDArray[np.float64]:
    """The training set's mean, whatever was observed.

    Args:
        statistics: Of the training set.

    Returns:
        (5,) Ward parameters.
    """
    return statistics.mean.copy()


def lambertian(surface: ObservedSurface, statistics: ParameterStatistics) -> NDArray[np.float64]:
    """Ward parameters of a matt surface in uniform light: Eq. 7 with ``rho_s`` = 0.

    ``rho_d`` is the least-squares ratio of F to B over the views, in linear sRGB, at most 1.
    ``alpha`` cannot be observed and is the training mean.

    Args:
        surface: What was observed.
        statistics: Of the training set.

    Returns:
        (5,) Ward parameters.
    """
    foreground = srgb.decode(surface.view_foreground.astype(np.float64) / 255)
    background = srgb.decode(surface.view_background.astype(np.float64) / 255)
    known = ~(np.isnan(foreground) | np.isnan(background)).any(axis=1)
    f, b = foreground[known], background[known]
    ratio = (f * b).sum(axis=0) / np.maximum((b * b).sum(axis=0), 1e-9)
    return np.array([*np.clip(ratio, 0.0, 1.0), 0.0, statistics.mean[ALPHA]])
