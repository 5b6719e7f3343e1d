# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The parts of an evaluation: each measures something and keeps it in a JSON file of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from reflest_core.evaluation.baselines import measure_baselines
from reflest_core.evaluation.contact_sheet import SHOWN, draw_contact_sheet
from reflest_core.evaluation.contenders import (
    Contender,
    EvaluationError,
    find_contenders,
    named,
)
from reflest_core.evaluation.lights import unseen_lights
from reflest_core.evaluation.perception import measure_perception, prepare_swatches
from reflest_core.evaluation.quick_check import write_expected
from reflest_core.evaluation.quick_set import QUICK_SET, VARIANT, save_quick_set
from reflest_core.evaluation.record_file import provenance_of, read_record, write_record
from reflest_core.evaluation.size_and_latency import measure_eight_bit, measure_latency
from reflest_core.evaluation.table_2 import Estimates, measure_table_2, measure_table_3
from reflest_core.evaluation.view_study import measure_views
from reflest_core.training.sample import Degradation, Sample, load_samples

SPLITS = ("validation", "unseen")


@dataclass(frozen=True)
class StudySettings:
    """What is evaluated and where the records go.

    ``runs``: a folder of trained variants, or None for the shipped weights. ``environments``:
    the data set's own, for pictures under unseen light. ``limit``: the first so many scenes of
    each split. ``optimised``: scenes of each split that the single-image optimiser gets.
    ``degradation``: faults that all scenes get.
    """

    data: Path
    out: Path
    command: str
    runs: Path | None = None
    environments: Path | None = None
    limit: int | None = None
    optimised: int = 40
    degradation: Degradation | None = None


class Study:
    """One evaluation; scenes and estimates are loaded when a part needs them."""

    def __init__(self, settings: StudySettings) -> None:
        self.settings = settings

    @cached_property
    def contenders(self) -> list[Contender]:
        """Variants with weights."""
        return find_contenders(self.settings.runs)

    @cached_property
    def splits(self) -> dict[str, list[Sample]]:
        """Validation and unseen scenes."""
        settings = self.settings
        return {
            split: load_samples(settings.data, split, settings.degradation)[: settings.limit]
            for split in SPLITS
        }

    @cached_property
    def estimates(self) -> Estimates:
        """Those that Table 2 was made from."""
        record = read_record(self.settings.out / "estimates.json")
        if record is None:
            raise EvaluationError("there are no estimates yet; run --parts table-2 first")
        made: Estimates = {
            split: {name: np.array(values) for name, values in record[split].items()}
            for split in SPLITS
        }
        if len(next(iter(made["validation"].values()))) != len(self.splits["validation"]):
            raise EvaluationError(
                f"{self.settings.out / 'estimates.json'} is of other scenes; run --parts table-2"
            )
        return made

    def run(self, part: str) -> None:
        """Measure ``part``, one of :data:`PARTS`, and write its record."""
        self.write(part, PARTS[part](self))

    def write(self, name: str, figures: dict[str, Any]) -> None:
        """Write ``<name>.json``."""
        provenance = provenance_of(self.settings.command, self.settings.data)
        write_record(self.settings.out / f"{name}.json", provenance, figures)


def _table_2(study: Study) -> dict[str, Any]:
    rows, estimates = measure_table_2(study.contenders, study.splits)
    rounded = {
        split: {name: made.round(6).tolist() for name, made in of.items()}
        for split, of in estimates.items()
    }
    truths = {f"{s}_truths": [x.ward.tolist() for x in of] for s, of in study.splits.items()}
    study.write("estimates", {**rounded, **truths})
    samples = study.splits["validation"]
    study.write("table-3", measure_table_3(study.contenders, samples, estimates["validation"]))
    return {"rows": rows}


def _perception(study: Study) -> dict[str, Any]:
    samples, estimates = study.splits["validation"], study.estimates["validation"]
    lights = unseen_lights(study.settings.data, study.settings.environments)
    swatches = prepare_swatches(lights)
    shown = np.random.default_rng(5).permutation(len(samples))[:SHOWN]
    draw_contact_sheet(
        study.settings.out / "contact-sheet.png",
        swatches,
        [samples[index] for index in shown],
        {name: made[shown] for name, made in estimates.items()},
    )
    return {"lights": list(lights), **measure_perception(swatches, samples, estimates)}


def _quick(study: Study) -> dict[str, Any]:
    contender = named(study.contenders, VARIANT)
    if contender is None:
        raise EvaluationError(f"the quick set needs weights of {VARIANT}; train it first")
    save_quick_set(QUICK_SET, study.splits["validation"])
    return write_expected(contender)


PARTS: dict[str, Callable[[Study], dict[str, Any]]] = {
    "table-2": _table_2,
    "views": lambda study: measure_views(study.contenders, study.splits["validation"]),
    "latency": lambda study: measure_latency(study.contenders, study.splits["validation"]),
    "eight-bit": lambda study: measure_eight_bit(study.contenders, study.splits["validation"]),
    "baselines": lambda study: measure_baselines(
        study.contenders, study.splits, study.settings.optimised
    ),
    "perception": _perception,
    "quick": _quick,
}
"""In the order in which they are run."""
