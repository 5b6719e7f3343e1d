# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Accuracy against time: lightnet with fewer voxels than it was trained to look at."""

from __future__ import annotations

import dataclasses
from typing import Any

from reflest_core.evaluation.contenders import Contender
from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.statistics.accuracy import accuracy
from reflest_core.evaluation.studies.size_and_latency import time_estimates
from reflest_core.training.data.sample import Sample

VOXELS = (8, 16, 24, 32, 48)


def measure_time_accuracy(contender: Contender, samples: list[Sample]) -> dict[str, Any]:
    """RMSE and milliseconds of an estimate (one thread, features included) by voxels."""
    points = []
    for voxels in VOXELS:
        estimator = contender.estimator()
        estimator.predictor.voxels = voxels
        made = estimate_all(estimator, samples, f"{contender.name}, {voxels} voxels")
        found = accuracy(made.ward, samples, estimator.predictor.card.statistics)
        points.append(
            {
                "voxels": voxels,
                "rmse": found.ward.overall,
                "over_scenes": dataclasses.asdict(found.over_scenes),
                **time_estimates(estimator.predictor, samples),
            }
        )
    return {"scenes": len(samples), "points": points}
