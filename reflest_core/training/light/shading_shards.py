# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Shading of every scene of a data set, made once: a file beside each shard, in parallel."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, fields
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import safe_open
from safetensors.numpy import save_file
from tqdm import tqdm

from reflest_core.features.light.shading import Shading
from reflest_core.models.lightnet import VOXELS
from reflest_core.synbrdf.scene_file import load_shard
from reflest_core.training.light.shaded_scene import SceneDraw, shaded, training_draw
from reflest_core.training.sample import TrainingError

HELD_OUT_VIEWS = (100, 30, 10)
"""Every validation and unseen scene is looked at with so many views."""
LARGEST = 6e4
"""Near the largest float16; only ratios to no light at all come there."""
_OF_VOXELS = {f.name for f in fields(Shading)} - {"scene_fit", "zones"}


@dataclass(frozen=True)
class Shadings:
    """L looks at scenes: ``arrays`` are those of :class:`Shading` with a leading L, float16.

    ``ward``: (L, 5) float32 truth. ``views``: (L,) how many. ``scene``: (L,) index in its split.
    ``environment``: (L,) name.
    """

    arrays: Mapping[str, NDArray[Any]]
    ward: NDArray[np.float32]
    views: NDArray[np.int64]
    scene: NDArray[np.int64]
    environment: NDArray[np.str_]

    def __len__(self) -> int:
        return len(self.ward)

    def where(self, chosen: NDArray[Any]) -> Shadings:
        """Only the chosen looks: a mask or indices."""
        arrays = {name: array[chosen] for name, array in self.arrays.items()}
        return Shadings(
            arrays, self.ward[chosen], self.views[chosen], self.scene[chosen],
            self.environment[chosen],
        )  # fmt: skip


def make_shadings(data: Path, out: Path, split: str, looks: int, jobs: int) -> None:
    """Write what is missing of ``split`` into ``out``; ``looks`` at every training scene."""
    out.mkdir(parents=True, exist_ok=True)
    shards = sorted(data.glob(f"{split}-*.safetensors"))
    if not shards:
        raise TrainingError(f"{data} holds no shard of split {split!r}; generate the data first")
    missing = [shard for shard in shards if not (out / shard.name).exists()]
    with (
        ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool,
        tqdm(total=len(shards), initial=len(shards) - len(missing), unit="shard") as progress,
    ):
        for done in as_completed(
            [pool.submit(_shade_shard, shard, out, split, looks) for shard in missing]
        ):
            done.result()
            progress.update()


def load_shadings(folders: list[Path], split: str) -> Shadings:
    """All looks at one split's scenes in some folders of :func:`make_shadings`, in order."""
    parts = [_load(path) for folder in folders for path in sorted(folder.glob(f"{split}-*"))]
    if not parts:
        names = ", ".join(map(str, folders))
        raise TrainingError(f"{names} hold no shading of split {split!r}; make it first")
    return Shadings(
        {name: np.concatenate([p.arrays[name] for p in parts]) for name in parts[0].arrays},
        np.concatenate([p.ward for p in parts]),
        np.concatenate([p.views for p in parts]),
        np.concatenate([p.scene for p in parts]),
        np.concatenate([p.environment for p in parts]),
    )


def as_row(look: Shading) -> dict[str, NDArray[Any]]:
    """The arrays of a look as stored: padded to :data:`VOXELS` voxels, float16."""
    row = {}
    for field in fields(Shading):
        array = getattr(look, field.name)
        if field.name in _OF_VOXELS:
            padding = [(0, VOXELS - len(array))] + [(0, 0)] * (array.ndim - 1)
            array = np.pad(array, padding)
        is_flag = array.dtype == np.bool_
        row[field.name] = array if is_flag else np.clip(array, -LARGEST, LARGEST).astype("float16")
    return row


def _shade_shard(shard: Path, out: Path, split: str, looks: int) -> None:
    rows, cards = [], []
    for scene in load_shard(shard):
        truth = [*scene.truth.rho_d, scene.truth.rho_s, scene.truth.alpha]
        for number, draw, rng in _draws(split, scene.index, looks):
            look = shaded(scene, draw, rng)
            if look is None:
                continue
            rows.append(as_row(look))
            cards.append([truth, draw.views, scene.index, scene.environment, number])
    arrays = {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    temporary = out / f".{shard.name}.partial"
    save_file(arrays, temporary, {"looks": json.dumps(cards)})
    os.replace(temporary, out / shard.name)


def _draws(
    split: str, index: int, looks: int
) -> Iterator[tuple[int, SceneDraw, np.random.Generator]]:
    for number in range(looks if split == "train" else len(HELD_OUT_VIEWS)):
        rng = np.random.default_rng([index, number])
        if split == "train":
            yield number, training_draw(rng), rng
        else:
            yield number, SceneDraw(HELD_OUT_VIEWS[number]), rng


def _load(path: Path) -> Shadings:
    with safe_open(path, framework="numpy") as file:
        cards = json.loads(file.metadata()["looks"])
        arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    truth, views, scene, environment, _ = zip(*cards, strict=True)
    return Shadings(
        arrays,
        np.array(truth, np.float32),
        np.array(views),
        np.array(scene),
        np.array(environment),
    )
