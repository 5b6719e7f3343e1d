# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A data set of relit training scenes, made from one that was rendered."""

from __future__ import annotations

from concurrent.futures import Executor
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from reflest_core.errors import ReflestError
from reflest_core.source_fingerprint import source_fingerprint
from reflest_core.synbrdf.generation.data_folder import begin_manifest, read_manifest
from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.generation.shard_workers import WorkerError, finished
from reflest_core.synbrdf.lights.environments import EnvironmentSource, load_environments
from reflest_core.synbrdf.relit.relit_scene import NATURAL_SHARE, is_relightable, randomly_relit
from reflest_core.synbrdf.scenes.scene_file import (
    FORMAT,
    load_shard,
    shard_bytes,
)
from reflest_core.synbrdf.scenes.seeding import Purpose, generator
from reflest_core.synbrdf.scenes.splits import Split
from reflest_core.whole_file import write_whole

RELIGHTING = "reflest_core.synbrdf.relit.relighting"
"""The module that, with all that it imports, decides the bytes."""


class RelightingRefused(ReflestError):
    """A data set cannot be relit as asked."""


@dataclass(frozen=True)
class Relighting:
    """What to relight: each relightable training scene of a data set, some times over.

    Attributes:
        source: Folder of the data set.
        copies: Of each scene.
        environments: What the source was generated with; its unseen share lights nothing.
        extra_environments: What the source was generated with.
        without: Names of environments that light nothing.
        natural_share: Share of scenes that are lit by one environment as it is.
    """

    source: Path
    copies: int
    environments: Path | None = None
    extra_environments: Path | None = None
    without: tuple[str, ...] = ()
    natural_share: float = NATURAL_SHARE

    def lights(self) -> list[EnvironmentSource]:
        """The environments of training; raises :class:`RelightingRefused` where they are others."""
        manifest = read_manifest(self.source)
        generation = Generation(
            manifest["seed"],
            {},
            environments=self.environments,
            without=self.without,
            extra_environments=self.extra_environments,
        )
        generation.check_extra()
        if generation.environment_names() != manifest["environments"]:
            raise RelightingRefused(
                f"--environments are not those that {self.source} was generated with: its unseen "
                "lights could not be told from the others"
            )
        return generation.sources(Split.TRAIN).environments

    def manifest(self, lights: list[EnvironmentSource]) -> dict[str, Any]:
        """What a resumed run must agree with.

        Args:
            lights: environments to draw from.
        """
        source = read_manifest(self.source)
        return {
            "format": FORMAT,
            "seed": source["seed"],
            "scenes": {"train": self.copies * source["scenes"]["train"]},
            "lighting": "relit",
            "source": {name: source.get(name) for name in ("lighting", "code", "scenes")},
            "copies": self.copies,
            "natural_share": self.natural_share,
            "without": sorted(self.without),
            "environments": source["environments"],
            "lights": [light.name for light in lights],
            "code": source_fingerprint(RELIGHTING),
        }


def relight(out: Path, relighting: Relighting, workers: AbstractContextManager[Executor]) -> None:
    """Write every shard that is not there yet; a killed run goes on where it was.

    Args:
        out: folder to make.
        relighting: what to relight.
        workers: processes or a cluster, as a context; they read the source themselves, and only
            this process writes.
    """
    if relighting.copies < 1:
        raise RelightingRefused(f"--copies is {relighting.copies}, but must be 1 or more")
    if not 0.0 <= relighting.natural_share <= 1.0:
        raise RelightingRefused(f"--natural is {relighting.natural_share}, but must be 0 to 1")
    shards = sorted(relighting.source.glob("train-*.safetensors"))
    if not shards:
        raise RelightingRefused(f"{relighting.source} holds no training scenes to relight")
    lights = relighting.lights()
    manifest = relighting.manifest(lights)
    begin_manifest(out, manifest)
    tasks = [RelitShard(shard, copy) for copy in range(relighting.copies) for shard in shards]
    missing = [task for task in tasks if not (out / task.file_name).exists()]
    made = partial(relit_agreed, lights, manifest["code"], relighting.natural_share)
    with (
        tqdm(total=len(tasks), initial=len(tasks) - len(missing), unit="shard") as progress,
        closing(finished(workers, made, missing)) as relit_shards,
    ):
        for task, shard in relit_shards:
            write_whole(out / task.file_name, shard)
            progress.update()


@dataclass(frozen=True)
class RelitShard:
    """The scenes of ``shard`` for the ``copy``-th time."""

    shard: Path
    copy: int

    @property
    def file_name(self) -> str:
        """Such as ``train-00040-1.safetensors``."""
        return f"{self.shard.stem}-{self.copy}.safetensors"


def relit_agreed(
    lights: list[EnvironmentSource], code: str, natural_share: float, task: RelitShard
) -> bytes:
    """Relight every scene of a shard that Eq. 1 holds for, which may be fewer than all.

    Args:
        lights: environments to draw from.
        code: fingerprint of the sources.
        natural_share: share of scenes under unmixed environments.
        task: one shard.

    Returns:
        The new shard's bytes.

    Raises:
        WorkerError: This worker has another code.
    """
    if source_fingerprint(RELIGHTING) != code:
        raise WorkerError("a worker has another code: install the same reflest on every machine")
    maps = load_environments(lights)
    seed = int(read_manifest(task.shard.parent)["seed"])
    relit = []
    for scene in load_shard(task.shard):
        if not is_relightable(scene):
            continue
        stream = generator(seed, Split(scene.split), scene.index, Purpose.RELIGHT)
        rng = np.random.default_rng([int(stream.integers(2**63)), task.copy])
        relit.append(randomly_relit(scene, maps, rng, natural_share))
    return shard_bytes(relit)
