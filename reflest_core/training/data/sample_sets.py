# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The scenes of a training: from a SynBRDF folder, or packed for another machine."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reflest_core.synbrdf.generation.data_folder import read_manifest
from reflest_core.synbrdf.realism.settings import Effect
from reflest_core.training.data.sample import Degradation, Sample, TrainingError, load_samples
from reflest_core.training.data.sample_file import read_samples, save_samples

PACKED = "packed.json"
SCENES_A_FILE = 700
"""About 50 MB."""


@dataclass(frozen=True)
class TrainingData:
    """Scenes to train on.

    Attributes:
        training: To learn from.
        validation: To choose weights by.
        described: What the weight file's card says of them.
    """

    training: list[Sample]
    validation: list[Sample]
    described: dict[str, Any]


def load_training_data(
    folders: Sequence[Path], degradation: Degradation | None = None
) -> TrainingData:
    """Load training scenes of all folders and validation scenes of the first.

    With ``degradation`` every training scene comes a second time, with faults; a packed folder has
    those that it was packed with.

    Args:
        folders: Of SynBRDF, or packed; validation scenes are the first's.
        degradation: Faults that every scene gets; None for none.
    """
    first = _load(folders[0], degradation)
    if len(folders) == 1:
        return first
    parts = [first, *(_load(folder, degradation, is_first=False) for folder in folders[1:])]
    training = [sample for part in parts for sample in part.training]
    described = {**first.described, "also": [part.described for part in parts[1:]]}
    return TrainingData(training, first.validation, described)


def _load(folder: Path, degradation: Degradation | None, is_first: bool = True) -> TrainingData:
    if (folder / PACKED).is_file():
        described = _description(folder / PACKED)
        return TrainingData(_unpack(folder, "train"), _unpack(folder, "validation"), described)
    training = load_samples(folder, "train")
    validation = load_samples(folder, "validation") if is_first else []
    manifest = read_manifest(folder)
    described = {
        "seed": manifest.get("seed"),
        "train": len(training),
        "validation": len(validation),
    }
    if degradation is not None:
        training += load_samples(folder, "train", degradation)
        effects = [effect.value for effect in degradation.effects]
        described["realism"] = "all" if len(effects) == len(Effect) else effects
    return TrainingData(training, validation, described)


def pack(data: TrainingData, folder: Path) -> None:
    """Write scenes into a folder, in files of about 50 MB.

    Args:
        data: What is written.
        folder: Where.
    """
    for split, samples in (("train", data.training), ("validation", data.validation)):
        for first in range(0, len(samples), SCENES_A_FILE):
            some = samples[first : first + SCENES_A_FILE]
            save_samples(folder / f"{split}-{first:05d}.safetensors", some)
    (folder / PACKED).write_text(json.dumps(data.described, indent=1) + "\n")


def _unpack(folder: Path, split: str) -> list[Sample]:
    paths = sorted(folder.glob(f"{split}-*.safetensors"))
    return [sample for path in paths for sample in read_samples(path)]


def _description(path: Path) -> dict[str, Any]:
    try:
        described: dict[str, Any] = json.loads(path.read_text())
    except ValueError as error:
        raise TrainingError(f"{path} is damaged ({error}); pack the scenes again") from error
    return described
