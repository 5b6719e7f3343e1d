# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Estimates of a whole split, each as the live path would make it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from reflest_core.estimation.estimator import physical_ward
from reflest_core.models.predictor import Predictor
from reflest_core.training.sample import Sample


def estimate_all(predictor: Predictor, samples: list[Sample], title: str) -> NDArray[np.float64]:
    """(S, 5) physical Ward parameters; shows progress under ``title``."""
    return np.stack(
        [
            physical_ward(predictor.predict(sample.surface).ward)
            for sample in tqdm(samples, desc=title, unit="scene", leave=False)
        ]
    )
