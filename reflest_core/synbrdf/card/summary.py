# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One line about each scene of a generated set."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from reflest_core.brdf.gloss import to_labcd
from reflest_core.brdf.lab import luminance
from reflest_core.synbrdf.scenes.scene_file import SceneFileError, SynbrdfScene, load_scenes

FULL_SCALE = 255


@dataclass(frozen=True)
class SceneSummary:
    """Truth and capture of one scene.

    Attributes:
        split: Name of the split.
        shape: Name of the shape.
        environment: Name of the light.
        view_pattern: How the views are spread.
        rho_d: Linear sRGB, of the dominant material.
        luminance: Rec. 709, of ``rho_d``.
        rho_s: Specular albedo.
        alpha: Roughness.
        contrast: ``c`` of the paper's Eq. 2.
        exposure: Factor from radiance to the sensor's white.
        clipped: Share of observations with a channel at 255.
        observations: Of a point, on average.
        diameter: Of the surface, metres.
        distance: Of the cameras from the origin, on average, metres.
        on_object: Share of a view's pixels.
    """

    split: str
    shape: str
    environment: str
    view_pattern: str
    rho_d: tuple[float, float, float]
    luminance: float
    rho_s: float
    alpha: float
    contrast: float
    exposure: float
    clipped: float
    observations: float
    diameter: float
    distance: float
    on_object: float

    @classmethod
    def of(cls, scene: SynbrdfScene) -> SceneSummary:
        """Summarise one scene.

        Args:
            scene: the scene.
        """
        surface, truth = scene.surface, scene.materials.dominant.ward
        return cls(
            split=scene.split,
            shape=scene.shape,
            environment=scene.environment,
            view_pattern=scene.view_pattern,
            rho_d=truth.rho_d,
            luminance=float(luminance(np.array(truth.rho_d))),
            rho_s=truth.rho_s,
            alpha=truth.alpha,
            contrast=to_labcd(truth).c,
            exposure=scene.exposure,
            clipped=float((surface.colours == FULL_SCALE).any(axis=1).mean()),
            observations=float(surface.observation_counts.mean()),
            diameter=2.0 * float(np.linalg.norm(surface.positions, axis=1).max()),
            distance=float(np.linalg.norm(surface.view_centres, axis=1).mean()),
            on_object=float(scene.thumbnails.is_object.mean()),
        )


def summarise(folder: Path, splits: tuple[str, ...]) -> list[SceneSummary]:
    """Summarise all scenes of some splits that a set holds, finished or not.

    Args:
        folder: of the data set.
        splits: names of splits.
    """
    found = [SceneSummary.of(scene) for split in splits for scene in load_scenes(folder, split)]
    if not found:
        raise SceneFileError(f"{folder} holds no scenes yet; make them with 'synbrdf generate'")
    return found
