# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Which looks at which scenes are shaded, and by which code."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from reflest_core.models.model_choice import MODELS
from reflest_core.synbrdf.generation.source_fingerprint import source_fingerprint
from reflest_core.training.light.shaded_scene import SceneDraw, training_draw
from reflest_core.training.light.shading_axes import AXES

MEASURED_VIEWS = (100, 30, 10)
"""A scene that is measured is looked at with so many of its views, as they are."""
SOURCES = (
    "brdf",
    "light/known_light.py",
    "inference",
    "models/lightnet",
    "light",
    "surface",
    "surface/voxel_choice.py",
    "surface/tangent_frame.py",
    "light/exposure_correction.py",
    "light/exposure_gain.py",
    "light/light_map.py",
    "surface/observed_surface.py",
    "light/octahedral.py",
    "surface/thinning.py",
    "synbrdf/realism",
    "synbrdf/scenes/exposure.py",
    "synbrdf/relit/scene_light.py",
    "synbrdf/scenes/thumbnails.py",
    "training/data/augmentation.py",
    "training/light/look_plan.py",
    "training/light/shaded_scene.py",
    "training/light/shading_file.py",
    "training/data/scanned_scene.py",
)
"""The code that decides what a look shows, files and folders of ``reflest_core``."""


SHADED_PARTS = ("completion", "visibility")
"""Parts of ``lightnet`` that shading has: to do without them is to shade anew."""


@dataclass(frozen=True)
class LookPlan:
    """Looks at the scenes of ``split``.

    ``varied``: how many looks at each scene, with views, exposure and faults as
    :func:`training_draw` has them; 0: one for each of :data:`MEASURED_VIEWS`. ``only``: of scenes
    under one of these environments unmixed; of all scenes where it is empty. ``without``:
    parts of shading that are left out, of :data:`SHADED_PARTS`.
    """

    split: str
    varied: int = 0
    only: tuple[str, ...] = ()
    without: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Of the folder that its shadings are in."""
        kind = f"{self.varied}-looks" if self.varied else "measured"
        kind += "".join(f"-without-{part}" for part in self.without)
        if not self.only:
            return f"{self.split}-{kind}"
        names = hashlib.sha256(" ".join(self.only).encode()).hexdigest()
        return f"{self.split}-{kind}-only-{names[:8]}"

    def takes(self, environment: str) -> bool:
        """Whether a scene under ``environment`` is looked at."""
        return not self.only or environment in self.only

    def draws(self, index: int) -> Iterator[tuple[SceneDraw, np.random.Generator]]:
        """The looks at scene ``index``: always the same ones."""
        for number in range(self.varied or len(MEASURED_VIEWS)):
            rng = np.random.default_rng([index, number])
            yield training_draw(rng) if self.varied else SceneDraw(MEASURED_VIEWS[number]), rng

    def fingerprint(self, scenes: str) -> str:
        """Hash (hex) of this plan, of the code that follows it and of the ``scenes``' cards."""
        voxels, code = MODELS["lightnet"].voxels, source_fingerprint(SOURCES)
        decided = f"{self} {voxels} {sorted(AXES)} {code} {scenes}"
        return hashlib.sha256(decided.encode()).hexdigest()
