# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a data set is asked to be, and the shards that it is made of."""

from __future__ import annotations

import dataclasses
import enum
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.errors import ReflestError
from reflest_core.source_fingerprint import source_fingerprint
from reflest_core.synbrdf.lights.environment_likeness import SAME, likeness
from reflest_core.synbrdf.lights.environments import (
    EnvironmentSource,
    find_environments,
    load_environment,
    procedural_skies,
)
from reflest_core.synbrdf.path_tracing.mitsuba_runtime import missing_package
from reflest_core.synbrdf.path_tracing.path_counts import check_paths
from reflest_core.synbrdf.realism.settings import Realism
from reflest_core.synbrdf.scenes.material_sources import OPENSURFACES, Materials
from reflest_core.synbrdf.scenes.metering import Metering
from reflest_core.synbrdf.scenes.scene import Lighting, Scene, draw_scene
from reflest_core.synbrdf.scenes.scene_file import FORMAT, NEAR_FORMAT, SV_FORMAT
from reflest_core.synbrdf.scenes.splits import Sources, Split, sources_of
from reflest_core.synbrdf.scenes.surface_points import SurfaceKind
from reflest_core.synbrdf.shapes.mesh_file import MeshSource, find_meshes
from reflest_core.synbrdf.tabletop.tabletop_scene import draw_tabletop_scene

SHARD_SCENES = 20
SKIES = 24
"""Procedural environments, where no folder of environments is given."""
COMPARED_ROWS = 32
"""Height of the environments at which they are compared."""
RENDERING = "reflest_core.synbrdf.generation.shard_rendering"
"""The module that, with all that it imports, decides the bytes."""
PACKAGES = ("mitsuba", "drjit", "karellen-llvm-core", "numpy", "scipy", "scikit-image")
"""Libraries whose versions may change the bytes."""


class GenerationRefused(ReflestError):
    """A data set was asked for that cannot be made."""


class Product(enum.Enum):
    """What a scene shows."""

    OBJECT = "object"
    """One object of one material: the paper's set."""
    TABLETOP = "tabletop"
    """Objects of several materials on a table or in a corner: SynBRDF-SV."""


@dataclass(frozen=True)
class Generation:
    """What ``reflest synbrdf generate`` was asked for; with the code it decides every byte.

    Attributes:
        seed: Of the data set.
        scenes: How many, by the name of the split.
        points: Voxels of a scene.
        views: Cameras of a scene.
        samples: Paths of an observation.
        environments: Files of environment maps; None for procedural skies.
        meshes: Files of meshes; None for procedural shapes alone.
        lighting: Where light comes from.
        without: Environments that neither train nor validation uses, kept to develop on.
        realism: The faults of real captures; None for perfect cameras and surfaces.
        metering: What the camera exposes for.
        extra_environments: Further ones, of training scenes alone; they leave the splits of
            ``environments`` as they are.
        product: Single objects, or objects on tables.
        materials: What materials are drawn from; its table of fits is for the unseen split alone,
            which then shares no material with the others.
        surface: Where voxels come from.
    """

    seed: int
    scenes: dict[str, int]
    points: int = 400
    views: int = 100
    samples: int = 64
    environments: Path | None = None
    meshes: Path | None = None
    lighting: Lighting = Lighting.NATURAL
    without: tuple[str, ...] = ()
    realism: Realism | None = None
    metering: Metering = Metering.FRAME
    extra_environments: Path | None = None
    product: Product = Product.OBJECT
    materials: Materials = OPENSURFACES
    surface: SurfaceKind = SurfaceKind.EXACT

    def __post_init__(self) -> None:
        bounds = {
            "seed": (self.seed, 0, 2**63),
            "points": (self.points, 1, 100_000),
            "views": (self.views, 1, 65_535),
            "samples": (self.samples, 1, 65_536),
            **{split: (count, 0, 10_000_000) for split, count in self.scenes.items()},
        }
        for name, (value, low, high) in bounds.items():
            if not low <= value <= high:
                raise GenerationRefused(f"--{name} is {value}, but must be {low} to {high}")
        check_paths(self.samples)
        if self.product is Product.TABLETOP and self.lighting is Lighting.DIVERSE:
            raise GenerationRefused("--product tabletop goes with --lighting natural or near")
        if self.product is Product.TABLETOP and self.metering is not Metering.FRAME:
            raise GenerationRefused("--product tabletop goes with --metering frame")

    def sources(self, split: Split) -> Sources:
        """The environments and meshes of one split.

        Args:
            split: train, validation or unseen.
        """
        sources = sources_of(split, self._environments(), self._meshes(), self.seed)
        unknown = set(self.without) - {source.name for source in self._environments()}
        if unknown:
            raise GenerationRefused(f"--without names no environment: {', '.join(sorted(unknown))}")
        kept = [source for source in sources.environments if source.name not in self.without]
        if split is Split.TRAIN:
            kept += self._extra()
        return dataclasses.replace(sources, environments=kept)

    def scene(self, split: Split, index: int) -> Scene:
        """Draw a scene.

        Args:
            split: Train, validation or unseen.
            index: Within the split.
        """
        sources, materials = self.sources(split), self.materials_of(split)
        if self.product is Product.TABLETOP:
            is_near = self.lighting is Lighting.NEAR
            return draw_tabletop_scene(
                self.seed, split, index, sources, self.views, materials, is_near
            )
        return draw_scene(self.seed, split, index, sources, self.views, self.lighting, materials)

    def materials_of(self, split: Split) -> Materials:
        """What the materials of one split are drawn from.

        Args:
            split: Train, validation or unseen.
        """
        if split is Split.UNSEEN or self.materials.fits is None:
            return self.materials
        return dataclasses.replace(self.materials, fits=None)

    def check_extra(self) -> None:
        """Refuse a further environment that is one of the others under another name."""
        known = [(source.name, _small(source)) for source in self._environments()]
        for source in self._extra():
            shown = _small(source)
            for name, radiance in known:
                if likeness(shown, radiance) > SAME:
                    raise GenerationRefused(
                        f"{source.name} of --extra-environments shows the same light as {name} of "
                        "--environments: take it out, so that what is held out stays unseen"
                    )

    def environment_names(self) -> list[str]:
        """Of all splits, but the further ones."""
        return [source.name for source in self._environments()]

    def manifest(self) -> dict[str, Any]:
        """What a resumed run must agree with."""
        return {
            "format": self._format(),
            "product": self.product.value,
            "materials": self.materials.card(),
            "surface": self.surface.value,
            "seed": self.seed,
            "scenes": self.scenes,
            "points": self.points,
            "views": self.views,
            "samples": self.samples,
            "lighting": self.lighting.value,
            "without": sorted(self.without),
            "realism": None if self.realism is None else dataclasses.asdict(self.realism),
            "metering": self.metering.value,
            "environments": self.environment_names(),
            "extra_environments": [source.name for source in self._extra()],
            "meshes": [source.name for source in self._meshes()],
            "versions": _versions(),
            "code": source_fingerprint(RENDERING),
        }

    def _format(self) -> str:
        if self.product is Product.TABLETOP:
            return SV_FORMAT
        return NEAR_FORMAT if self.lighting is Lighting.NEAR else FORMAT

    def _environments(self) -> list[EnvironmentSource]:
        if self.environments is None:
            return procedural_skies(SKIES)
        return find_environments(self.environments)

    def _extra(self) -> list[EnvironmentSource]:
        if self.extra_environments is None:
            return []
        return find_environments(self.extra_environments)

    def _meshes(self) -> list[MeshSource]:
        return [] if self.meshes is None else find_meshes(self.meshes)


def _small(source: EnvironmentSource) -> NDArray[np.float32]:
    return load_environment(source, COMPARED_ROWS)


def _versions() -> dict[str, str]:
    found = {}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError as error:
            raise missing_package(package) from error
    return found


@dataclass(frozen=True)
class ShardTask:
    """Scenes ``first`` up to ``last`` of one split, in one file."""

    split: Split
    first: int
    last: int

    @property
    def file_name(self) -> str:
        """Such as ``train-00040.safetensors``, by the first scene."""
        return f"{self.split.value}-{self.first:05d}.safetensors"

    @property
    def scenes(self) -> int:
        """How many."""
        return self.last - self.first


def shard_tasks(generation: Generation) -> Iterator[ShardTask]:
    """All shards, the splits interleaved, so that an unfinished set holds some of each.

    Args:
        generation: what the data set was asked to be.
    """
    tasks = []
    for name, count in generation.scenes.items():
        for first in range(0, count, SHARD_SCENES):
            last = min(first + SHARD_SCENES, count)
            tasks.append((first / count, ShardTask(Split(name), first, last)))
    yield from (task for _, task in sorted(tasks, key=lambda pair: pair[0]))
