# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A data set of relit training scenes, made from one that was rendered."""

from __future__ import annotations

from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from reflest_core.errors import ReflestError
from reflest_core.synbrdf.data_folder import begin_manifest, read_manifest
from reflest_core.synbrdf.environments import EnvironmentSource, load_environment
from reflest_core.synbrdf.generation import Generation
from reflest_core.synbrdf.process_pool import process_pool
from reflest_core.synbrdf.relit_scene import drawn_anew, is_relightable
from reflest_core.synbrdf.scene_file import (
    FORMAT,
    load_shard,
    shard_bytes,
    write_atomically,
)
from reflest_core.synbrdf.seeding import Purpose, generator
from reflest_core.synbrdf.source_fingerprint import source_fingerprint
from reflest_core.synbrdf.splits import Split


class RelightingRefused(ReflestError):
    """A data set cannot be relit as asked."""


@dataclass(frozen=True)
class Relighting:
    """Each relightable training scene of the data set in ``source``, ``copies`` times.

    ``environments``, ``extra_environments``: as the source was generated with. Their unseen share
    and what is named in ``without`` lights nothing.
    """

    source: Path
    copies: int
    environments: Path | None = None
    extra_environments: Path | None = None
    without: tuple[str, ...] = ()

    def lights(self) -> list[EnvironmentSource]:
        """The environments of training; raises :class:`RelightingRefused` where they are others."""
        manifest = read_manifest(self.source)
        generation = Generation(
            manifest["seed"], {}, environments=self.environments, without=self.without,
            extra_environments=self.extra_environments,
        )  # fmt: skip
        generation.check_extra()
        if generation.environment_names() != manifest["environments"]:
            raise RelightingRefused(
                f"--environments are not those that {self.source} was generated with: its unseen "
                "lights could not be told from the others"
            )
        return generation.sources(Split.TRAIN).environments

    def manifest(self, lights: list[EnvironmentSource]) -> dict[str, Any]:
        """What a resumed run must agree with."""
        source = read_manifest(self.source)
        return {
            "format": FORMAT,
            "seed": source["seed"],
            "scenes": {"train": self.copies * source["scenes"]["train"]},
            "lighting": "relit",
            "source": {name: source.get(name) for name in ("lighting", "code", "scenes")},
            "copies": self.copies,
            "without": sorted(self.without),
            "environments": source["environments"],
            "lights": [light.name for light in lights],
            "code": source_fingerprint(),
        }


def relight(out: Path, relighting: Relighting, jobs: int) -> None:
    """Write every shard that is not there yet; a killed run goes on where it was."""
    if relighting.copies < 1:
        raise RelightingRefused(f"--copies is {relighting.copies}, but must be 1 or more")
    shards = sorted(relighting.source.glob("train-*.safetensors"))
    if not shards:
        raise RelightingRefused(f"{relighting.source} holds no training scenes to relight")
    lights = relighting.lights()
    begin_manifest(out, relighting.manifest(lights))
    tasks = [(shard, copy) for copy in range(relighting.copies) for shard in shards]
    missing = [task for task in tasks if not _path(out, *task).exists()]
    with (
        process_pool(jobs) as pool,
        tqdm(total=len(tasks), initial=len(tasks) - len(missing), unit="shard") as bar,
    ):
        futures = [pool.submit(_relight_shard, *task, out, lights) for task in missing]
        try:
            for future in as_completed(futures):
                future.result()
                bar.update()
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise


def _relight_shard(shard: Path, copy: int, out: Path, lights: list[EnvironmentSource]) -> None:
    """Every scene that Eq. 1 holds for; a shard may end with fewer than it began with."""
    maps = [load_environment(light) for light in lights]
    seed = int(read_manifest(shard.parent)["seed"])
    relit = []
    for scene in load_shard(shard):
        if not is_relightable(scene):
            continue
        stream = generator(seed, Split(scene.split), scene.index, Purpose.RELIGHT)
        rng = np.random.default_rng([int(stream.integers(2**63)), copy])
        relit.append(drawn_anew(scene, maps, rng))
    write_atomically(_path(out, shard, copy), shard_bytes(relit))


def _path(out: Path, shard: Path, copy: int) -> Path:
    return out / f"{shard.stem}-{copy}.safetensors"
