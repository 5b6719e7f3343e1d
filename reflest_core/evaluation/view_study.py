# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Figure 6: error against the number of views, for HemiCNN and both forms of Grouplet."""

from __future__ import annotations

from typing import Any

import numpy as np

from reflest_core.evaluation.accuracy import accuracy
from reflest_core.evaluation.contenders import Contender, named
from reflest_core.evaluation.estimates import estimate_all
from reflest_core.training.augmentation import keep_views
from reflest_core.training.sample import Sample

VIEW_COUNTS = (5, 10, 20, 30, 50, 70, 100)
SEED = 6


def measure_views(contenders: list[Contender], samples: list[Sample]) -> dict[str, Any]:
    """RMSE of each network on validation scenes that keep only so many random views.

    The same views are kept for every network, and fewer are a subset of more.
    """
    hemicnn, grouplet = named(contenders, "hemicnn-rmse1"), named(contenders, "grouplet-rmse1")
    shown = [("HemiCNN", hemicnn), ("Grouplet-slow", grouplet)]
    if grouplet is not None:
        shown.insert(1, ("Grouplet-fast", grouplet.as_fast()))
    curves = []
    for title, contender in shown:
        if contender is None:
            continue
        predictor = contender.predictor()
        errors = []
        for count in VIEW_COUNTS:
            fewer = [_fewer(sample, count) for sample in samples]
            seen = [sample for sample in fewer if len(sample.surface.colours)]
            made = estimate_all(predictor, seen, f"{title}, {count} views")
            errors.append(accuracy(made, seen, predictor.card.statistics).ward.overall)
        curves.append({"network": title, "model_id": predictor.model_id, "rmse": errors})
    return {"views": list(VIEW_COUNTS), "scenes": len(samples), "curves": curves}


def _fewer(sample: Sample, count: int) -> Sample:
    views = len(sample.surface.view_centres)
    order = np.random.default_rng([SEED, sample.index]).permutation(views)
    surface = keep_views(sample.surface, order[:count])
    return Sample(surface, sample.ward, sample.environment, sample.index)
