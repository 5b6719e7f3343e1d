# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Looks to train ``lightnet`` on, to choose weights by, and to calibrate it on."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from reflest_core.synbrdf.generation.data_folder import read_manifest
from reflest_core.synbrdf.generation.source_fingerprint import source_fingerprint
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.light.look_plan import SHADED_PARTS, SOURCES, LookPlan
from reflest_core.training.light.shading_file import LookCard
from reflest_core.training.light.shading_shards import make_shadings
from reflest_core.training.light.shadings import Shadings, load_shadings
from reflest_core.training.recipe import Recipe


@dataclass(frozen=True)
class LightData:
    """``held_out``: looks under environments of which training saw nothing; None without any.

    ``described``: what the card says of them.
    """

    training: Shadings
    validation: Shadings
    held_out: Shadings | None = None
    described: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class ShadingPlace:
    """``folder`` of the shadings, which runs may share, and processes to make them in."""

    folder: Path
    jobs: int

    def made(self, data: Path, plan: LookPlan) -> list[Path]:
        """See :func:`make_shadings`."""
        return make_shadings(data, plan, self.folder, self.jobs)


def load_light_data(
    folders: list[Path], recipe: Recipe, looks: int, place: ShadingPlace
) -> LightData:
    """Shade what is not shaded yet, and load it.

    Every one of the data ``folders`` gives training scenes, with ``looks`` looks at each;
    validation and held-out looks are at scenes of the first alone, so that adding a folder leaves
    what is measured as it is. Held-out looks are at its training scenes.
    """
    hold_out, without = recipe.hold_out, _shaded_without(recipe)
    seeds = {folder.resolve().name: read_manifest(folder).get("seed") for folder in folders}

    def is_known(card: LookCard) -> bool:
        return not set(card.environment.split("+")) & set(hold_out)

    paths = [
        path
        for folder in folders
        for path in place.made(folder, LookPlan("train", looks, (), without))
    ]
    measured = LookPlan("validation", without=without)
    training = load_shadings(paths, is_known)
    return LightData(
        training,
        load_shadings(place.made(folders[0], measured), is_known),
        _held_out(folders[0], recipe, place) if hold_out else None,
        {
            "seeds": seeds,
            "train_looks": len(training),
            "looks_a_scene": looks,
            "shading_code": source_fingerprint(SOURCES),
        },
    )


def _held_out(data: Path, recipe: Recipe, place: ShadingPlace) -> Shadings:
    known = read_manifest(data).get("environments", [])
    for name in recipe.hold_out:
        if name not in known:
            raise TrainingError(
                f"{data} has no environment {name!r} to hold out; choose of {', '.join(known)}"
            )
    plan = LookPlan("train", 0, recipe.hold_out, _shaded_without(recipe))
    return load_shadings(place.made(data, plan))


def _shaded_without(recipe: Recipe) -> tuple[str, ...]:
    return tuple(part for part in recipe.without if part in SHADED_PARTS)
