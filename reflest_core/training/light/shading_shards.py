# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Looks at the scenes of a data set, shaded once: a file for each shard, in parallel."""

from __future__ import annotations

from concurrent.futures import as_completed
from pathlib import Path

import numpy as np
from safetensors import safe_open
from tqdm import tqdm

from reflest_core.models.threads import one_blas_thread
from reflest_core.synbrdf.generation.process_pool import process_pool
from reflest_core.synbrdf.scenes.scene_file import load_shard
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.light.look_plan import LookPlan
from reflest_core.training.light.shaded_scene import shaded
from reflest_core.training.light.shading_file import LookCard, as_row, read_cards, save_looks


def make_shadings(data: Path, plan: LookPlan, out: Path, jobs: int) -> list[Path]:
    """Make what is missing of ``plan`` in ``out``; return all its files, in order.

    Raises :class:`TrainingError` where there is nothing to look at, or what is there was made by
    other code or settings or of other scenes.
    """
    shards = sorted(data.glob(f"{plan.split}-*.safetensors"))
    if not shards:
        raise TrainingError(
            f"{data} holds no shard of split {plan.split!r}; generate the data first"
        )
    folder = out / data.resolve().name / plan.name
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / shard.name for shard in shards]
    missing = []
    for shard, path in zip(shards, paths, strict=True):
        if path.exists():
            read_cards(path, plan.fingerprint(_scenes(shard)))
        else:
            missing.append((shard, path))
    if not missing:
        return paths
    done = len(shards) - len(missing)
    with (
        process_pool(min(jobs, len(missing))) as pool,
        tqdm(total=len(shards), initial=done, unit="shard", desc=f"shading {plan.name}") as bar,
    ):
        futures = [pool.submit(_shade_shard, shard, path, plan) for shard, path in missing]
        try:
            for future in as_completed(futures):
                if left_out := future.result():
                    bar.write(f"{left_out} looks whose shading is not finite are left out")
                bar.update()
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    return paths


def _shade_shard(shard: Path, path: Path, plan: LookPlan) -> int:
    """Write the looks at one shard's scenes; return how many are of no use."""
    rows, cards, left_out = [], [], 0
    with one_blas_thread():
        for scene in load_shard(shard):
            if not plan.takes(scene.environment):
                continue
            ward = [*scene.truth.rho_d, scene.truth.rho_s, scene.truth.alpha]
            for draw, rng in plan.draws(scene.index):
                look = shaded(scene, draw, rng, plan.without)
                if look is None:
                    continue
                row = as_row(look)
                if not all(np.isfinite(array).all() for array in row.values()):
                    left_out += 1
                    continue
                rows.append(row)
                cards.append(LookCard(ward, draw.views, scene.index, scene.environment))
    save_looks(path, rows, cards, plan.fingerprint(_scenes(shard)))
    return left_out


def _scenes(shard: Path) -> str:
    """The cards of a shard's scenes, as it holds them."""
    with safe_open(shard, framework="numpy") as file:
        return str((file.metadata() or {}).get("scenes"))
