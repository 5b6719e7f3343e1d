"""Generating the sparse data set: shards, each from its own seeds, in any number of processes."""

from __future__ import annotations

import dataclasses
import json
import multiprocessing
import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tqdm import tqdm

from reflest_core.synbrdf.environments import EnvironmentSource, find_environments, procedural_skies
from reflest_core.synbrdf.scene import Lighting, draw_scene
from reflest_core.synbrdf.scene_file import FORMAT, MANIFEST, SceneFileError, save_shard, sha256
from reflest_core.synbrdf.shapes.mesh_file import MeshSource, find_meshes
from reflest_core.synbrdf.source_fingerprint import source_fingerprint
from reflest_core.synbrdf.splits import Sources, Split, sources_of

if TYPE_CHECKING:
    from reflest_core.synbrdf.sparse_scene import SparseRenderer

SHARD_SCENES = 20
SKIES = 24
"""Procedural environments, where no folder of environments is given."""
PACKAGES = ("mitsuba", "drjit", "karellen-llvm-core", "numpy", "scipy", "scikit-image")
"""Libraries whose versions may change the bytes."""


@dataclass(frozen=True)
class Generation:
    """What ``reflest synbrdf generate`` was asked for; with the code it decides every byte."""

    seed: int
    scenes: dict[str, int]
    points: int = 400
    views: int = 100
    samples: int = 64
    environments: Path | None = None
    meshes: Path | None = None
    lighting: Lighting = Lighting.NATURAL
    without: tuple[str, ...] = ()
    """Environments that neither train nor validation uses, kept to develop on."""

    def sources(self, split: Split) -> Sources:
        """The environments and meshes of one split."""
        sources = sources_of(split, self._environments(), self._meshes(), self.seed)
        kept = [source for source in sources.environments if source.name not in self.without]
        return dataclasses.replace(sources, environments=kept)

    def _environments(self) -> list[EnvironmentSource]:
        if self.environments is None:
            return procedural_skies(SKIES)
        return find_environments(self.environments)

    def _meshes(self) -> list[MeshSource]:
        return [] if self.meshes is None else find_meshes(self.meshes)

    def manifest(self) -> dict[str, Any]:
        """What a resumed run must agree with."""
        return {
            "format": FORMAT,
            "seed": self.seed,
            "scenes": self.scenes,
            "points": self.points,
            "views": self.views,
            "samples": self.samples,
            "lighting": self.lighting.value,
            "without": sorted(self.without),
            "environments": [source.name for source in self._environments()],
            "meshes": [source.name for source in self._meshes()],
            "versions": {name: version(name) for name in PACKAGES},
            "code": source_fingerprint(),
        }


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


def generate(folder: Path, generation: Generation, jobs: int) -> None:
    """Write every shard that is not there yet, then the manifest with the hashes of all.

    A killed run leaves only whole shards; the same call goes on and ends with the same bytes.
    """
    folder.mkdir(parents=True, exist_ok=True)
    _begin_manifest(folder, generation.manifest())
    tasks = list(shard_tasks(generation))
    missing = [task for task in tasks if not (folder / task.file_name).exists()]
    scenes = sum(task.last - task.first for task in tasks)
    done = scenes - sum(task.last - task.first for task in missing)
    context = multiprocessing.get_context("spawn")
    with (
        ProcessPoolExecutor(jobs, mp_context=context) as pool,
        tqdm(total=scenes, initial=done, unit="scene") as progress,
    ):
        running = {pool.submit(write_shard, folder, generation, task): task for task in missing}
        for finished in as_completed(running):
            finished.result()
            progress.update(running[finished].last - running[finished].first)
    hashes = {task.file_name: sha256(folder / task.file_name) for task in tasks}
    _write_json(folder / MANIFEST, {**generation.manifest(), "sha256": hashes})


def shard_tasks(generation: Generation) -> Iterator[ShardTask]:
    """All shards, the splits interleaved, so that an unfinished set holds some of each."""
    tasks = []
    for name, count in generation.scenes.items():
        for first in range(0, count, SHARD_SCENES):
            last = min(first + SHARD_SCENES, count)
            tasks.append((first / count, ShardTask(Split(name), first, last)))
    yield from (task for _, task in sorted(tasks, key=lambda pair: pair[0]))


def write_shard(folder: Path, generation: Generation, task: ShardTask) -> None:
    """Render one shard, in this process."""
    renderer = _renderer(generation.points, generation.views, generation.samples)
    sources = generation.sources(task.split)
    scenes = [
        renderer.render(
            draw_scene(
                generation.seed, task.split, index, sources, generation.views, generation.lighting
            ),
            generation.seed,
        )
        for index in range(task.first, task.last)
    ]
    save_shard(folder / task.file_name, scenes)


@cache
def _renderer(points: int, views: int, samples: int) -> SparseRenderer:
    """One renderer a process: its kernels compile once."""
    from reflest_core.synbrdf.sparse_scene import SparseRenderer, SparseSettings

    return SparseRenderer(SparseSettings(points, views, samples))


def _begin_manifest(folder: Path, manifest: dict[str, Any]) -> None:
    path = folder / MANIFEST
    if not path.exists():
        _write_json(path, manifest)
        return
    try:
        found = json.loads(path.read_text())
    except ValueError as error:
        raise SceneFileError(
            f"{path} is damaged ({error}); delete it and generate again"
        ) from error
    differing = sorted(key for key in manifest if found.get(key) != manifest[key])
    if differing:
        raise SceneFileError(
            f"{folder} was begun with another {', '.join(differing)}; use the same or another --out"
        )


def _write_json(path: Path, content: dict[str, Any]) -> None:
    temporary = path.with_suffix(".partial")
    temporary.write_text(json.dumps(content, indent=1, sort_keys=True) + "\n")
    os.replace(temporary, path)
