# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A ranking by appearance, in place of the paper's ten users: estimates rendered and compared."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from reflest_core.evaluation.paper_figures import TABLES_2_AND_3
from reflest_core.evaluation.pictures.image_distance import ImageDistance, image_distance
from reflest_core.evaluation.pictures.rendered_shapes import bumpy_sphere, sphere
from reflest_core.evaluation.pictures.swatches import (
    EnvironmentSwatch,
    PointLightSwatch,
    Swatch,
    point_light_directions,
)
from reflest_core.training.data.sample import Sample

METRICS = tuple(field.name for field in dataclasses.fields(ImageDistance))
Lights = dict[str, NDArray[np.float32]]
"""Environments by name: equirectangular radiance, linear."""


def prepare_swatches(lights: Lights) -> list[Swatch]:
    """Both shapes under every environment and under a point light in four places.

    Args:
        lights: Environments by name.
    """
    swatches: list[Swatch] = []
    for shape in (sphere(), bumpy_sphere()):
        for name, radiance in lights.items():
            swatches.append(EnvironmentSwatch.prepare(shape, name, radiance))
        for number, direction in enumerate(point_light_directions(), start=1):
            swatches.append(PointLightSwatch.prepare(shape, f"point light {number}", direction))
    return swatches


def measure_perception(
    swatches: list[Swatch], samples: list[Sample], estimates: dict[str, NDArray[np.float64]]
) -> dict[str, Any]:
    """Distances of each network's pictures from the truth's, and the networks' ranks.

    A network's rank on one material is by its mean FLIP over the swatches. Networks are ordered by
    their mean rank, as the paper orders them by the users' ranks.

    Args:
        swatches: Result of :func:`prepare_swatches`.
        samples: S scenes.
        estimates: (S, 5) Ward parameters by network.

    Returns:
        The record of the part ``perception``.
    """
    distances = np.empty((len(estimates), len(samples), len(swatches), len(METRICS)))
    for index, sample in enumerate(tqdm(samples, desc="pictures", unit="material", leave=False)):
        for place, swatch in enumerate(swatches):
            truth = swatch.picture(sample.ward)
            for number, made in enumerate(estimates.values()):
                distance = image_distance(truth, swatch.picture(made[index]))
                distances[number, index, place] = dataclasses.astuple(distance)
    flip = distances[..., 0].mean(axis=2)
    ranks = flip.argsort(axis=0).argsort(axis=0) + 1
    rows = [
        {
            "variant": name,
            **dict(zip(METRICS, distances[number].mean(axis=(0, 1)).tolist(), strict=True)),
            "mean_rank": float(ranks[number].mean()),
            "first": float((ranks[number] == 1).mean()),
            "paper_rank": _their_rank(name),
        }
        for number, name in enumerate(estimates)
    ]
    by_light = {
        name: {
            light: float(flip_of[:, [s.light.startswith(light) for s in swatches]].mean())
            for light in dict.fromkeys(_kind(swatch.light) for swatch in swatches)
        }
        for name, flip_of in zip(estimates, distances[..., 0], strict=True)
    }
    rows.sort(key=lambda row: row["mean_rank"])
    return {
        "materials": len(samples),
        "pictures": [f"{swatch.shape.name}, {swatch.light}" for swatch in swatches],
        "rows": rows,
        "flip_by_light": by_light,
        "rank_correlation": _rank_correlation(rows),
    }


def _their_rank(name: str) -> int | None:
    paper = TABLES_2_AND_3.get(name)
    return None if paper is None else paper.rank


def _kind(light: str) -> str:
    return "point light" if light.startswith("point light") else light


def _rank_correlation(rows: list[dict[str, Any]]) -> float | None:
    """Spearman's, of our order of the paper's variants and its users'; None for fewer than 3."""
    ranked = [row["paper_rank"] for row in rows if row["paper_rank"] is not None]
    if len(ranked) < 3:
        return None
    theirs = np.array(ranked).argsort().argsort()
    return float(np.corrcoef(np.arange(len(theirs)), theirs)[0, 1])
