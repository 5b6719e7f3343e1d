# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One evaluation: networks, scenes and estimates, for parts that keep figures in JSON files."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from reflest_core.evaluation.contenders import Contender, EvaluationError, find_contenders
from reflest_core.evaluation.estimates_file import read_estimates
from reflest_core.evaluation.pictures.lights import unseen_lights
from reflest_core.evaluation.pictures.perception import Lights, prepare_swatches
from reflest_core.evaluation.pictures.swatches import Swatch
from reflest_core.evaluation.record_file import provenance_of, write_record
from reflest_core.evaluation.shown_scenes import load_shown, shown
from reflest_core.evaluation.studies.study_settings import StudySettings
from reflest_core.evaluation.table_2 import Estimates
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.training.data.sample import Sample

SPLITS = ("validation", "unseen")


class Study:
    """Scenes and estimates are loaded when a part needs them."""

    def __init__(self, settings: StudySettings) -> None:
        self.settings = settings

    @cached_property
    def contenders(self) -> list[Contender]:
        """Networks with weights."""
        return find_contenders(self.settings.runs)

    @cached_property
    def scenes(self) -> dict[str, list[SynbrdfScene]]:
        """Validation and unseen scenes as they were generated."""
        settings = self.settings
        return {
            split: load_shown(settings.data, split, settings.degradation, settings.limit)
            for split in SPLITS
        }

    @cached_property
    def splits(self) -> dict[str, list[Sample]]:
        """The same after all their views."""
        return {split: [shown(scene) for scene in scenes] for split, scenes in self.scenes.items()}

    @cached_property
    def estimates(self) -> Estimates:
        """Those that Table 2 was made from."""
        path = self.settings.out / "estimates.json"
        made = read_estimates(path)
        if len(next(iter(made["validation"].values())).ward) != len(self.splits["validation"]):
            raise EvaluationError(f"{path} is of other scenes; run --parts table-2")
        return made

    @cached_property
    def lights(self) -> Lights:
        """Environments that no training scene stood in."""
        return unseen_lights(self.settings.data, self.settings.environments)

    @cached_property
    def swatches(self) -> list[Swatch]:
        """Shapes under these lights, to look at materials with."""
        return prepare_swatches(self.lights)

    def write(self, name: str, figures: dict[str, Any]) -> None:
        """Write ``<name>.json``."""
        provenance = provenance_of(self.settings.command, self.settings.data)
        write_record(self.settings.out / f"{name}.json", provenance, figures)
