# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes of a data set drawn again from the sources that it was generated from."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from reflest_core.environment.known_rooms import KnownRooms
from reflest_core.environment.room import Room
from reflest_core.evaluation.contenders import EvaluationError
from reflest_core.synbrdf.generation.data_folder import read_manifest
from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.lights.environments import load_environment
from reflest_core.synbrdf.scenes.metering import Metering
from reflest_core.synbrdf.scenes.scene import Lighting, Scene
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.synbrdf.scenes.splits import Split


class SourceScenes:
    """Draws scenes of the data set in ``data``; ``generation``: what it was asked to be."""

    def __init__(self, data: Path, environments: Path | None, meshes: Path | None) -> None:
        manifest = read_manifest(data)
        self.generation = generation_of(manifest, environments, meshes)

    def drawn(self, scene: SynbrdfScene) -> Scene:
        """The scene before it was rendered; :class:`EvaluationError` with other sources."""
        drawn = self.generation.scene(Split(scene.split), scene.index)
        if drawn.material != scene.truth or drawn.light.name != scene.environment:
            raise EvaluationError(
                f"scene {scene.index} of {scene.split} cannot be drawn again: --environments "
                "and --meshes are not those that the data set was generated with"
            )
        return drawn

    def training_rooms(self) -> KnownRooms:
        """A panorama of each environment that training scenes stand in, as it lies in its file."""
        sources = self.generation.sources(Split.TRAIN).environments
        rooms = [Room.of(source.name, load_environment(source)) for source in sources]
        return KnownRooms(rooms, "the environments of training")


def generation_of(
    manifest: dict[str, Any], environments: Path | None, meshes: Path | None
) -> Generation:
    """What the data set was asked to be, without its faults."""
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
