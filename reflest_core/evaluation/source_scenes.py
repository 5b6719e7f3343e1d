# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes and lights of a data set, loaded from the sources that it was generated from."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from reflest_core.environment.known_rooms import KnownRooms
from reflest_core.environment.room import Room
from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.pictures.perception import Lights
from reflest_core.rendering.environments import studio
from reflest_core.synbrdf.generation.data_folder import read_manifest
from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.lights.environments import find_environments, load_environment
from reflest_core.synbrdf.lights.procedural_sky import procedural_sky
from reflest_core.synbrdf.scenes.metering import Metering
from reflest_core.synbrdf.scenes.scene import Lighting, Scene
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.synbrdf.scenes.splits import Split, sources_of


class SourceScenes:
    """Generates scenes of a data set again, before they are rendered.

    Attributes:
        generation: The settings of the data set.
    """

    def __init__(self, data: Path, environments: Path | None, meshes: Path | None) -> None:
        """Find the sources.

        Args:
            data: folder of the data set.
            environments: the folder that it was generated from; None for procedural skies.
            meshes: the folder that it was generated from; None for procedural shapes.
        """
        manifest = read_manifest(data)
        self.generation = generation_of(manifest, environments, meshes)

    def drawn(self, scene: SynbrdfScene) -> Scene:
        """The scene before it was rendered.

        Args:
            scene: A scene of the data set.

        Raises:
            EvaluationError: environments or meshes are not those of the data set.
        """
        drawn = self.generation.scene(Split(scene.split), scene.index)
        is_same = drawn.painted.dominant.ward == scene.materials.dominant.ward
        if not is_same or drawn.light.name != scene.environment:
            raise EvaluationError(
                f"scene {scene.index} of {scene.split} cannot be drawn again: --environments "
                "and --meshes are not those that the data set was generated with"
            )
        return drawn

    def training_rooms(self) -> KnownRooms:
        """A panorama of each environment of the training scenes, in the orientation of its file."""
        sources = self.generation.sources(Split.TRAIN).environments
        rooms = [Room.of(source.name, load_environment(source)) for source in sources]
        return KnownRooms(rooms, "the environments of training")


def generation_of(
    manifest: dict[str, Any], environments: Path | None, meshes: Path | None
) -> Generation:
    """The settings of a data set, without its faults.

    Args:
        manifest: The data set's manifest.
        environments: File or folder of environments, or None for the procedural ones.
        meshes: Folder of meshes, or None for the procedural ones.
    """
    return Generation(
        manifest["seed"],
        manifest["scenes"],
        views=manifest["views"],
        environments=environments,
        meshes=meshes,
        lighting=Lighting(manifest.get("lighting", Lighting.NATURAL.value)),
        without=tuple(manifest.get("without", ())),
        metering=Metering(manifest.get("metering", Metering.FRAME.value)),
    )


COUNT = 3
SKY_SEEDS = (900_001, 900_002)
"""Far from any seed of a data set's skies."""


def unseen_lights(data: Path, environments: Path | None) -> Lights:
    """Environments that no training scene stood in.

    Args:
        data: The data set.
        environments: What the data set was generated with, or None for two procedural skies.

    Returns:
        Equirectangular linear radiance (H, 2 H, 3) float32 by name.
    """
    if environments is None:
        skies = {f"sky {seed}": procedural_sky(seed) for seed in SKY_SEEDS}
        return {"studio": studio(), **skies}
    seed = int(read_manifest(data)["seed"])
    held_out = sources_of(Split.UNSEEN, find_environments(environments), [], seed).environments
    spread = [held_out[k * len(held_out) // COUNT] for k in range(min(COUNT, len(held_out)))]
    return {source.name: load_environment(source) for source in spread}
