# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Figure 6: error against the number of views, for lightnet and for the paper's networks."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.estimation.estimator import Estimator
from reflest_core.evaluation.contenders import LIGHTNET, Contender, named
from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.shown_scenes import random_subset, shown
from reflest_core.evaluation.statistics.accuracy import Accuracy, accuracy
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.training.data.sample import Sample

VIEW_COUNTS = (5, 10, 20, 30, 50, 70, 100)
SCENES = 100
"""Of each split, for the curves."""
FEW_VIEWS = 10
"""The number of views at which lightnet is measured on every scene."""
SEED = 6


def measure_views(
    contenders: list[Contender], splits: dict[str, list[SynbrdfScene]]
) -> dict[str, Any]:
    """RMSE of each network on scenes that show only so many random views, light included.

    The same views are shown to every network, and fewer are a subset of more.
    """
    curves = []
    subsets = {split: random_subset(scenes, SCENES, SEED) for split, scenes in splits.items()}
    for split, scenes in subsets.items():
        looks = {count: few_views(scenes, count) for count in VIEW_COUNTS}
        for title, contender in _shown_networks(contenders):
            estimator = contender.estimator()
            measured = [
                _accuracy(estimator, samples, f"{title}, {count} views of {split}")
                for count, samples in looks.items()
            ]
            curves.append(
                {
                    "network": title,
                    "model_id": estimator.predictor.model_id,
                    "split": split,
                    "rmse": [found.ward.overall for found in measured],
                    "over_environments": [found.over_environments for found in measured],
                }
            )
    return {
        "views": list(VIEW_COUNTS),
        "scenes": {split: len(scenes) for split, scenes in subsets.items()},
        "curves": curves,
        "few": _few(named(contenders, LIGHTNET), splits),
    }


def few_views(scenes: list[SynbrdfScene], count: int) -> list[Sample]:
    """The scenes after ``count`` random views, without those of which these show nothing."""
    looks = (shown(scene, drawn_views(scene, count)) for scene in scenes)
    return [sample for sample in looks if len(sample.surface.colours)]


def _shown_networks(contenders: list[Contender]) -> list[tuple[str, Contender]]:
    hemicnn, grouplet = named(contenders, "hemicnn-rmse1"), named(contenders, "grouplet-rmse1")
    ours = named(contenders, LIGHTNET)
    networks = [
        ("HemiCNN", hemicnn),
        ("Grouplet-fast", None if grouplet is None else grouplet.as_fast()),
        ("Grouplet-slow", grouplet),
        ("lightnet", ours),
    ]
    return [(title, contender) for title, contender in networks if contender is not None]


def _few(contender: Contender | None, splits: dict[str, list[SynbrdfScene]]) -> Any:
    """What lightnet reaches at :data:`FEW_VIEWS` views of every scene, by split."""
    if contender is None:
        return None
    estimator = contender.estimator()
    measured = {
        split: dataclasses.asdict(
            _accuracy(estimator, few_views(scenes, FEW_VIEWS), f"{FEW_VIEWS} views of all {split}")
        )
        for split, scenes in splits.items()
    }
    return {"views": FEW_VIEWS, "accuracy": measured}


def _accuracy(estimator: Estimator, samples: list[Sample], title: str) -> Accuracy:
    made = estimate_all(estimator, samples, title)
    return accuracy(made.ward, samples, estimator.predictor.card.statistics)


def drawn_views(scene: SynbrdfScene, count: int) -> NDArray[np.int64]:
    """``count`` random views, in their order; fewer are a subset of more."""
    views = len(scene.surface.view_centres)
    order = np.random.default_rng([SEED, scene.index]).permutation(views)
    return np.sort(order[:count])
