# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is evaluated and where the records go."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from reflest_core.training.data.sample import Degradation


@dataclass(frozen=True)
class StudySettings:
    """``command``: how to repeat it, without this machine's folders.

    ``runs``: a folder of trained variants, or None for the shipped weights. ``environments``:
    the data set's own, for pictures under unseen light; with its ``meshes`` too, scenes that were
    estimated badly are rendered again. ``limit``: the first so many scenes of
    each split. ``optimised``: scenes of each split that the single-image optimiser gets.
    ``degradation``: faults that all scenes get. ``ablation``: a folder of lightnets trained with
    one thing left out each. ``unhardened``: a folder of variants trained without
    the faults of a real capture. ``held_out``: folders of lightnets trained by one recipe, each
    without other environments.
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
