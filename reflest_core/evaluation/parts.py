# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The parts of an evaluation, by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from reflest_core.evaluation.estimates import SceneEstimates, as_figures
from reflest_core.evaluation.networks import (
    LIGHTNET,
    EvaluationError,
    find_networks,
    network_named,
    require_lightnet,
)
from reflest_core.evaluation.pictures.contact_sheet import SHOWN, draw_contact_sheet
from reflest_core.evaluation.pictures.failure_pictures import (
    Picture,
    draw_failure,
    fullest_view,
    thumbnail_picture,
)
from reflest_core.evaluation.pictures.perception import measure_perception
from reflest_core.evaluation.quick_check import QUICK_SET, VARIANT, save_quick_set, write_expected
from reflest_core.evaluation.shown_scenes import load_shown, random_subset
from reflest_core.evaluation.source_scenes import SourceScenes
from reflest_core.evaluation.studies.ablation import collect_ablation
from reflest_core.evaluation.studies.baselines import measure_baselines
from reflest_core.evaluation.studies.calibration import measure_calibration
from reflest_core.evaluation.studies.failures import find_failures
from reflest_core.evaluation.studies.held_out_lights import measure_held_out_lights
from reflest_core.evaluation.studies.look_around_study import measure_look_around
from reflest_core.evaluation.studies.realism import measure_realism, measure_realism_training
from reflest_core.evaluation.studies.size_and_latency import (
    measure_eight_bit,
    measure_latency,
)
from reflest_core.evaluation.studies.stability import find_captures, measure_stability
from reflest_core.evaluation.studies.study import Study
from reflest_core.evaluation.studies.table_scenes import find_tables, measure_materials
from reflest_core.evaluation.studies.view_study import measure_views
from reflest_core.evaluation.table_2 import measure_table_2, measure_table_3
from reflest_core.models.card import ParameterStatistics
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.training.data.sample import Sample

Figures = dict[str, Any]

RENDERED = 100
"""Materials of the part ``perception``, drawn by :data:`RENDERED_SEED`."""
RENDERED_SEED = 5
FEW_SCENES = 100
"""Of a split, for parts that estimate every scene many times; drawn by :data:`SUBSET_SEED`."""
SUBSET_SEED = 13


def _table_2(study: Study) -> Figures:
    rows, estimates = measure_table_2(study.networks, study.splits)
    study.write("estimates", as_figures(estimates, study.splits))
    samples = study.splits["validation"]
    study.write("table-3", measure_table_3(study.networks, samples, estimates["validation"]))
    return {"rows": rows}


def _perception(study: Study) -> Figures:
    samples, made = study.splits["validation"], study.estimates["validation"]
    drawn = np.random.default_rng(RENDERED_SEED).permutation(len(samples))[:RENDERED]
    estimates = {name: of.ward[drawn] for name, of in made.items()}
    judged = [samples[row] for row in drawn]
    draw_contact_sheet(
        study.settings.out / "contact-sheet.png",
        study.swatches,
        judged[:SHOWN],
        {name: of[:SHOWN] for name, of in estimates.items()},
    )
    measured = measure_perception(study.swatches, judged, estimates)
    return {"lights": list(study.lights), **measured}


def _quick(study: Study) -> Figures:
    network = network_named(study.networks, VARIANT)
    if network is None:
        raise EvaluationError(f"the quick set needs weights of {VARIANT}; train it first")
    save_quick_set(QUICK_SET, study.splits["validation"])
    return write_expected(network)


def _lightnets(study: Study, split: str) -> tuple[SceneEstimates, ParameterStatistics]:
    """Its estimates of a split, as Table 2 has them, and what z-scores are made with."""
    statistics = require_lightnet(study.networks).predictor().card.statistics["ward"]
    return study.estimates[split][LIGHTNET], statistics


def _calibration(study: Study) -> Figures:
    measured = {}
    for split, samples in study.splits.items():
        made, statistics = _lightnets(study, split)
        measured[split] = measure_calibration(made, samples, statistics)
    return {"splits": measured}


def _held_out_lights(study: Study) -> Figures:
    folders = study.settings.held_out
    if not folders:
        raise EvaluationError(
            "part held-out-lights needs --held-out RUN..., trainings of lightnet with --hold-out"
        )
    return measure_held_out_lights(folders)


def _failures(study: Study) -> Figures:
    scenes, samples = study.scenes["unseen"], study.splits["unseen"]
    made, statistics = _lightnets(study, "unseen")
    found = find_failures(made, scenes, samples, statistics)
    photographed = _photographer(study)
    for number, failure in enumerate(found["failures"], start=1):
        row = failure["row"]
        failure["picture"] = f"failures/{number:02d}.png"
        draw_failure(
            study.settings.out / failure["picture"],
            photographed(scenes[row]),
            samples[row].surface.light,
            study.swatches[0],
            samples[row].ward,
            made.ward[row],
        )
    return found


def _photographer(study: Study) -> Callable[[SynbrdfScene], Picture]:
    """Pictures of scenes: rendered again where the data set's meshes are given."""
    settings = study.settings
    if settings.meshes is None:
        return lambda scene: thumbnail_picture(scene, fullest_view(scene))
    from reflest_core.evaluation.pictures.close_ups import CloseUps

    close_ups = CloseUps(settings.data, settings.environments, settings.meshes)
    return lambda scene: close_ups.picture(scene, fullest_view(scene))


def _ablation(study: Study) -> Figures:
    folder = study.settings.ablation
    if folder is None:
        raise EvaluationError("part ablation needs --ablation FOLDER, with trainings of lightnet")
    return collect_ablation(folder)


def _realism(study: Study) -> Figures:
    return measure_realism(study.networks, _few_clean_scenes(study))


def _realism_training(study: Study) -> Figures:
    folder = study.settings.unhardened
    if folder is None:
        raise EvaluationError(
            "part realism-training needs --unhardened FOLDER, with trainings without --realism"
        )
    unhardened = [one for one in find_networks(folder) if one.name != LIGHTNET]
    return measure_realism_training(study.networks, unhardened, _few_clean_scenes(study))


def _few_clean_scenes(study: Study) -> list[SynbrdfScene]:
    """Without the faults that ``--realism`` may have given the others."""
    settings = study.settings
    clean = load_shown(settings.data, "validation", None, settings.limit)
    return random_subset(clean, FEW_SCENES, SUBSET_SEED)


def _look_around(study: Study) -> Figures:
    settings = study.settings
    if settings.environments is None:
        raise EvaluationError("part look-around needs the data set's --environments and --meshes")
    sources = SourceScenes(settings.data, settings.environments, settings.meshes)
    return measure_look_around(
        require_lightnet(study.networks), study.scenes, sources.drawn, sources.training_rooms()
    )


def _stability(study: Study) -> Figures:
    return measure_stability(find_captures(study.settings.data)[: study.settings.limit])


def _materials(study: Study) -> Figures:
    settings = study.settings
    return measure_materials(find_tables(settings.data), settings.limit, settings.environments)


def _few_samples(study: Study) -> list[Sample]:
    return random_subset(study.splits["validation"], FEW_SCENES, SUBSET_SEED)


PARTS: dict[str, Callable[[Study], Figures]] = {
    "table-2": _table_2,
    "views": lambda study: measure_views(study.networks, study.scenes),
    "look-around": _look_around,
    "calibration": _calibration,
    "held-out-lights": _held_out_lights,
    "failures": _failures,
    "ablation": _ablation,
    "realism": _realism,
    "realism-training": _realism_training,
    "stability": _stability,
    "latency": lambda study: measure_latency(study.networks, study.splits["validation"]),
    "eight-bit": lambda study: measure_eight_bit(study.networks, _few_samples(study)),
    "baselines": lambda study: measure_baselines(
        study.networks, study.splits, study.settings.optimised
    ),
    "perception": _perception,
    "materials": _materials,
    "quick": _quick,
}
"""In the order in which they are run."""


def run_part(study: Study, part: str) -> None:
    """Measure one part and write its record.

    Args:
        study: The networks, scenes and settings.
        part: A key of :data:`PARTS`.

    Raises:
        EvaluationError: an option that the part needs is missing.
    """
    study.write(part, PARTS[part](study))
