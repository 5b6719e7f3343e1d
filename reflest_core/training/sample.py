"""A scene as training sees it: the observed surface and the truth, nothing else."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.errors import ReflestError
from reflest_core.features.voxel_choice import MIN_OBSERVATIONS
from reflest_core.fusion.observed_surface import ObservedSurface
from reflest_core.synbrdf.scene_file import SynbrdfScene, load_scenes

LEAST_USABLE_VOXELS = 5


class TrainingError(ReflestError):
    """Training or evaluation cannot go on with what it was given."""


@dataclass(frozen=True)
class Sample:
    """``ward``: (5,) float64 true ``rho_d`` (3), ``rho_s``, ``alpha``."""

    surface: ObservedSurface
    ward: NDArray[np.float64]

    def parameters(self, kind: str) -> NDArray[np.float64]:
        """(5,) truth as ``ward`` or ``labcd``."""
        return self.ward if kind == "ward" else ward_to_labcd(self.ward)


def load_samples(folder: Path, split: str) -> list[Sample]:
    """All usable scenes of one split of a SynBRDF folder, in order."""
    samples = [_sample(scene) for scene in _usable(load_scenes(folder, split))]
    if not samples:
        raise TrainingError(f"{folder} holds no scenes of split {split!r}; generate them first")
    return samples


def _usable(scenes: Iterable[SynbrdfScene]) -> Iterable[SynbrdfScene]:
    for scene in scenes:
        seen = scene.surface.observation_counts >= MIN_OBSERVATIONS
        if seen.sum() >= LEAST_USABLE_VOXELS:
            yield scene


def _sample(scene: SynbrdfScene) -> Sample:
    truth = scene.truth
    return Sample(scene.surface, np.array([*truth.rho_d, truth.rho_s, truth.alpha]))
