# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One evaluation: its settings, networks, scenes and estimates, each loaded on demand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from reflest_core.evaluation.estimates import Estimates, read_estimates
from reflest_core.evaluation.networks import EvaluatedNetwork, EvaluationError, find_networks
from reflest_core.evaluation.pictures.perception import Lights, prepare_swatches
from reflest_core.evaluation.pictures.swatches import Swatch
from reflest_core.evaluation.record_file import provenance_of, write_record
from reflest_core.evaluation.shown_scenes import load_shown, shown
from reflest_core.evaluation.source_scenes import unseen_lights
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.training.data.sample import Degradation, Sample


@dataclass(frozen=True)
class StudySettings:
    """What is evaluated and where the records go.

    Attributes:
        data: Folder of the data set.
        out: Folder of the records.
        command: The command line without folders of this machine.
        runs: A folder of trained variants, or None for the shipped weights.
        environments: The data set's own, for pictures under unseen environments; None if not given.
        limit: Only the first so many scenes of each split; None for all.
        optimised: Scenes of each split for the single-image optimiser.
        degradation: Faults that all scenes get, or None.
        ablation: A folder of lightnets trained with one part left out each.
        meshes: The data set's own, so that badly estimated scenes can be rendered from nearby.
        unhardened: A folder of variants trained without the faults of a real capture.
        held_out: Folders of lightnets trained by one recipe without different environments.
    """

    data: Path
    out: Path
    command: str
    runs: Path | None = None
    environments: Path | None = None
    limit: int | None = None
    optimised: int = 8
    degradation: Degradation | None = None
    ablation: Path | None = None
    meshes: Path | None = None
    unhardened: Path | None = None
    held_out: tuple[Path, ...] = ()


SPLITS = ("validation", "unseen")


class Study:
    """One evaluation.

    Attributes:
        settings: What is evaluated.
    """

    def __init__(self, settings: StudySettings) -> None:
        """Load the scenes.

        Args:
            settings: what to evaluate and where.
        """
        self.settings = settings

    @cached_property
    def networks(self) -> list[EvaluatedNetwork]:
        """The networks with weights."""
        return find_networks(self.settings.runs)

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
        """The same scenes as samples, with all their views."""
        return {split: [shown(scene) for scene in scenes] for split, scenes in self.scenes.items()}

    @cached_property
    def estimates(self) -> Estimates:
        """The estimates that Table 2 was computed from.

        Raises:
            EvaluationError: there are none, or they are of other scenes.
        """
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
        """Shapes under these environments, to render materials on."""
        return prepare_swatches(self.lights)

    def write(self, name: str, figures: dict[str, Any]) -> None:
        """Write the record ``<name>.json``.

        Args:
            name: The part's name.
            figures: What was measured.
        """
        provenance = provenance_of(self.settings.command, self.settings.data)
        write_record(self.settings.out / f"{name}.json", provenance, figures)
