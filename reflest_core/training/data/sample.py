# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scene as training sees it: the observed surface, the truth, and where it stood."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
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
    """A surface of one material.

    Attributes:
        surface: What was observed.
        ward: (5,) float64, the true ``rho_d`` (3), ``rho_s``, ``alpha``.
        environment: Name of the light.
        index: Of the scene in its split.
    """

    surface: ObservedSurface
    ward: NDArray[np.float64]
    environment: str = ""
    index: int = 0

    def parameters(self, kind: str) -> NDArray[np.float64]:
        """Return the truth (5,) in one parameterisation.

        Args:
            kind: ``ward`` or ``labcd``.
        """
        return self.ward if kind == "ward" else ward_to_labcd(self.ward)


@dataclass(frozen=True)
class Degradation:
    """The faults of a real capture, drawn for each scene.

    Attributes:
        realism: Which faults, and how strong.
        seed: Of what is random.
    """

    realism: Realism
    seed: int

    @property
    def effects(self) -> list[Effect]:
        """The faults that are on."""
        return [effect for effect in Effect if self.realism.is_on(effect)]

    def applied(self, scene: SynbrdfScene) -> SynbrdfScene:
        """Return a scene with its faults, always the same ones.

        Args:
            scene: The scene.
        """
        rng = generator(self.seed, Split(scene.split), scene.index, Purpose.REALISM)
        return degrade(scene, self.realism, rng)


def load_samples(folder: Path, split: str, degradation: Degradation | None = None) -> list[Sample]:
    """Load all usable scenes of a split, in order.

    Args:
        folder: Of a SynBRDF set.
        split: ``train``, ``validation`` or ``unseen``.
        degradation: Faults that every scene gets; None for none.

    Raises:
        TrainingError: There is none.
    """
    samples = [sample_of(scene) for scene in usable_scenes(folder, split, degradation)]
    if not samples:
        raise TrainingError(f"{folder} holds no scenes of split {split!r}; generate them first")
    return samples


def usable_scenes(
    folder: Path, split: str, degradation: Degradation | None = None
) -> Iterator[SynbrdfScene]:
    """Read the scenes of a split that show enough of a surface, in order.

    A scene of several materials gives one of each (:meth:`.SynbrdfScene.parts`).

    Args:
        folder: Of a SynBRDF set.
        split: ``train``, ``validation`` or ``unseen``.
        degradation: Faults that every scene gets; None for none.
    """
    scenes: Iterable[SynbrdfScene] = load_scenes(folder, split)
    if degradation is not None:
        scenes = map(degradation.applied, scenes)
    for scene in chain.from_iterable(scene.parts() for scene in scenes):
        seen = scene.surface.observation_counts >= MIN_OBSERVATIONS
        if seen.sum() >= LEAST_USABLE_VOXELS:
            yield scene


def sample_of(scene: SynbrdfScene) -> Sample:
    """Make the sample of a scene of one material, without the light in its background.

    Args:
        scene: The scene.
    """
    truth = scene.materials.dominant.ward
    ward = np.array([*truth.rho_d, truth.rho_s, truth.alpha])
    return Sample(scene.surface, ward, scene.environment, scene.index)
