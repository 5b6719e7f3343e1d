# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scene as training sees it: the observed surface, the truth, and where it stood."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.errors import ReflestError
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.voxel_choice import MIN_OBSERVATIONS
from reflest_core.synbrdf.realism.degrade import degrade
from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene, load_scenes
from reflest_core.synbrdf.scenes.seeding import Purpose, generator
from reflest_core.synbrdf.scenes.splits import Split

LEAST_USABLE_VOXELS = 5


class TrainingError(ReflestError):
    """Training or evaluation cannot go on with what it was given."""


@dataclass(frozen=True)
class Sample:
    """``ward``: (5,) float64 true ``rho_d`` (3), ``rho_s``, ``alpha``.

    ``environment``: the light's name. ``index``: of the scene in its split.
    """

    surface: ObservedSurface
    ward: NDArray[np.float64]
    environment: str = ""
    index: int = 0

    def parameters(self, kind: str) -> NDArray[np.float64]:
        """(5,) truth as ``ward`` or ``labcd``."""
        return self.ward if kind == "ward" else ward_to_labcd(self.ward)


@dataclass(frozen=True)
class Degradation:
    """The faults that scenes get, drawn from ``seed`` for each scene."""

    realism: Realism
    seed: int

    @property
    def effects(self) -> list[Effect]:
        """Those that change anything."""
        return [effect for effect in Effect if self.realism.is_on(effect)]

    def applied(self, scene: SynbrdfScene) -> SynbrdfScene:
        """``scene`` with its faults; always the same ones."""
        rng = generator(self.seed, Split(scene.split), scene.index, Purpose.REALISM)
        return degrade(scene, self.realism, rng)


def load_samples(folder: Path, split: str, degradation: Degradation | None = None) -> list[Sample]:
    """All usable scenes of one split of a SynBRDF folder, in order; with faults if given."""
    samples = [sample_of(scene) for scene in usable_scenes(folder, split, degradation)]
    if not samples:
        raise TrainingError(f"{folder} holds no scenes of split {split!r}; generate them first")
    return samples


def usable_scenes(
    folder: Path, split: str, degradation: Degradation | None = None
) -> Iterator[SynbrdfScene]:
    """The scenes of a split that show enough of a surface, in order; with faults if given."""
    scenes: Iterable[SynbrdfScene] = load_scenes(folder, split)
    if degradation is not None:
        scenes = map(degradation.applied, scenes)
    for scene in scenes:
        seen = scene.surface.observation_counts >= MIN_OBSERVATIONS
        if seen.sum() >= LEAST_USABLE_VOXELS:
            yield scene


def sample_of(scene: SynbrdfScene) -> Sample:
    """What an estimate of the scene sees, and the truth; without the light in the background."""
    truth = scene.truth
    ward = np.array([*truth.rho_d, truth.rho_s, truth.alpha])
    return Sample(scene.surface, ward, scene.environment, scene.index)
