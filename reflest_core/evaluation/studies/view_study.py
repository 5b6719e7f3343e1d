# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Figure 6: error against the number of views, for lightnet and the paper's networks."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.estimation.estimator import Estimator
from reflest_core.evaluation.estimates import estimate_all
from reflest_core.evaluation.networks import LIGHTNET, EvaluatedNetwork, network_named
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
    networks: list[EvaluatedNetwork], splits: dict[str, list[SynbrdfScene]]
) -> dict[str, Any]:
    """RMSE of each network on scenes of which only some random views are known, light included.

    Every network gets the same views, and a smaller number is a subset of a larger one.

    Args:
        networks: The networks to compare.
        splits: The scenes of each split.

    Returns:
        The record of the part ``views``.
    """
    curves = []
    subsets = {split: random_subset(scenes, SCENES, SEED) for split, scenes in splits.items()}
    for split, scenes in subsets.items():
        samples_by_count = {count: few_views(scenes, count) for count in VIEW_COUNTS}
        for title, network in _shown_networks(networks):
            estimator = network.estimator()
            measured = [
                _accuracy(estimator, samples, f"{title}, {count} views of {split}")
                for count, samples in samples_by_count.items()
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
        "few": _few(network_named(networks, LIGHTNET), splits),
    }


def few_views(scenes: list[SynbrdfScene], count: int) -> list[Sample]:
    """The scenes with ``count`` random views, without those that these views do not show.

    Args:
        scenes: Scenes of the data set.
        count: Number of views.
    """
    samples = (shown(scene, drawn_views(scene, count)) for scene in scenes)
    return [sample for sample in samples if len(sample.surface.colours)]


def _shown_networks(networks: list[EvaluatedNetwork]) -> list[tuple[str, EvaluatedNetwork]]:
    grouplet = network_named(networks, "grouplet-rmse1")
    curves = [
        ("HemiCNN", network_named(networks, "hemicnn-rmse1")),
        ("Grouplet-fast", None if grouplet is None else grouplet.as_fast()),
        ("Grouplet-slow", grouplet),
        ("lightnet", network_named(networks, LIGHTNET)),
    ]
    return [(title, network) for title, network in curves if network is not None]


def _few(network: EvaluatedNetwork | None, splits: dict[str, list[SynbrdfScene]]) -> Any:
    """What lightnet reaches at :data:`FEW_VIEWS` views of every scene, by split."""
    if network is None:
        return None
    estimator = network.estimator()
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
    """Indices of ``count`` random views in ascending order; fewer are a subset of more.

    Args:
        scene: A scene of the data set.
        count: Number of views.

    Returns:
        (count,) int64.
    """
    views = len(scene.surface.view_centres)
    order = np.random.default_rng([SEED, scene.index]).permutation(views)
    return np.sort(order[:count])
