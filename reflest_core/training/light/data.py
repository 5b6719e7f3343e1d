# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Simulated scans to train ``lightnet`` on, to choose weights by, and to calibrate it on."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from reflest_core.models.recipe import Recipe
from reflest_core.source_fingerprint import source_fingerprint
from reflest_core.synbrdf.generation.data_folder import read_manifest
from reflest_core.synbrdf.scenes.scene import ROOM
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.light.scan_file import ScanCard
from reflest_core.training.light.scan_plan import SCAN_PARTS, SOURCES, ScanPlan
from reflest_core.training.light.scan_shards import make_scans
from reflest_core.training.light.scanned_materials import scan_scenes
from reflest_core.training.light.stored_scans import StoredScans, load_scans

ONE_HELD_OUT_OF = 10
"""Of so many lights of scanned scenes, one is for validation and calibration alone."""


@dataclass(frozen=True)
class LightData:
    """Simulated scans.

    Attributes:
        training: Those to learn from.
        validation: Those to choose weights by.
        held_out: Those under environments that training never saw; None without any.
        described: What the weight file's card says of them.
    """

    training: StoredScans
    validation: StoredScans
    held_out: StoredScans | None = None
    described: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class ScanFolder:
    """Where simulated scans are kept.

    Attributes:
        folder: The folder; several trainings may share it.
        jobs: Processes that simulate.
    """

    folder: Path
    jobs: int

    def made(self, data: Path, plan: ScanPlan) -> list[Path]:
        """Simulate the scans of a plan that are missing; return all files.

        Args:
            data: Folder of a SynBRDF set.
            plan: Which scans.
        """
        return make_scans(data, plan, self.folder, self.jobs)


def load_light_data(
    folders: list[Path], recipe: Recipe, scans: int, place: ScanFolder
) -> LightData:
    """Simulate the scans that are missing, and load all.

    Validation and held-out scans are of scenes of the first folder alone, so that adding a folder
    does not change what is measured. Held-out scans are of its training scenes.

    Args:
        folders: Of SynBRDF; each gives training scenes.
        recipe: The training's.
        scans: How many of each training scene.
        place: Where simulated scans are kept.

    Raises:
        TrainingError: There is no scene, or no environment of a name to hold out.
    """
    hold_out, without = recipe.hold_out, _scan_parts(recipe)
    seeds = {folder.resolve().name: read_manifest(folder).get("seed") for folder in folders}

    def is_known(card: ScanCard) -> bool:
        return not set(card.environment.split("+")) & set(hold_out)

    paths = [
        path
        for folder in folders
        for path in place.made(folder, ScanPlan("train", scans, (), without))
    ]
    measured = ScanPlan("validation", without=without)
    training = load_scans(paths, is_known)
    return LightData(
        training,
        load_scans(place.made(folders[0], measured), is_known),
        _held_out(folders[0], recipe, place) if hold_out else None,
        {
            "seeds": seeds,
            "train_looks": len(training),
            "looks_a_scene": scans,
            "shading_code": source_fingerprint(*SOURCES),
        },
    )


def load_scene_data(folders: list[Path], recipe: Recipe, place: ScanFolder) -> LightData:
    """Scan the scenes that have not been scanned yet, and load the materials found in all.

    Every tenth light, by a hash of its name, is held out for validation and calibration.

    Args:
        folders: Each holds bags of ``reflest synbrdf tabletop``.
        recipe: The training's; environments of its ``hold_out`` are left out altogether.
        place: Where what is learned from is kept.

    Raises:
        TrainingError: There is no scene, or too few lights to hold one out.
    """
    paths = [path for one in folders for path in scan_scenes(one, place.folder, place.jobs)]
    without = set(recipe.hold_out)

    def is_known(card: ScanCard) -> bool:
        return not set(card.environment.split("+")) & without

    training = load_scans(paths, lambda card: is_known(card) and not _is_for_validation(card))
    held_out = load_scans(paths, lambda card: is_known(card) and _is_for_validation(card))
    return LightData(
        training,
        held_out,
        held_out,
        {
            "scenes": len(paths),
            "train_looks": len(training),
            "held_out_looks": len(held_out),
            "shading_code": source_fingerprint("reflest_core.training.light.scanned_materials"),
        },
    )


def _is_for_validation(card: ScanCard) -> bool:
    """Whether a scene's light is held out; every room is a light of its own."""
    light = f"room {card.scene}" if card.environment == ROOM else card.environment
    return zlib.crc32(light.encode()) % ONE_HELD_OUT_OF == 0


def _held_out(data: Path, recipe: Recipe, place: ScanFolder) -> StoredScans:
    known = read_manifest(data).get("environments", [])
    for name in recipe.hold_out:
        if name not in known:
            raise TrainingError(
                f"{data} has no environment {name!r} to hold out; choose of {', '.join(known)}"
            )
    plan = ScanPlan("train", 0, recipe.hold_out, _scan_parts(recipe))
    return load_scans(place.made(data, plan))


def _scan_parts(recipe: Recipe) -> tuple[str, ...]:
    return tuple(part for part in recipe.without if part in SCAN_PARTS)
