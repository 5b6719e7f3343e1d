# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Simulated scans of a data set, made once: a file for each shard, in parallel."""

from __future__ import annotations

from concurrent.futures import as_completed
from itertools import chain
from pathlib import Path

import numpy as np
from safetensors import safe_open
from tqdm import tqdm

from reflest_core.models.linear_algebra import one_blas_thread
from reflest_core.synbrdf.generation.process_pool import process_pool
from reflest_core.synbrdf.scenes.scene_file import load_shard
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.light.scan_file import ScanCard, as_row, read_cards, save_scans
from reflest_core.training.light.scan_plan import ScanPlan
from reflest_core.training.light.simulated_scan import simulated_scan


def make_scans(data: Path, plan: ScanPlan, out: Path, jobs: int) -> list[Path]:
    """Simulate the scans of a plan that are missing.

    Args:
        data: Folder of a SynBRDF set.
        plan: Which scans.
        out: Folder for the scans of several sets and plans.
        jobs: Processes.

    Returns:
        All files of the plan, in order.

    Raises:
        TrainingError: There is no shard, or what is there was made by other code or settings, or of
            other scenes.
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
        tqdm(total=len(shards), initial=done, unit="shard", desc=f"simulating {plan.name}") as bar,
    ):
        futures = [pool.submit(_simulate_shard, shard, path, plan) for shard, path in missing]
        try:
            for future in as_completed(futures):
                if left_out := future.result():
                    bar.write(f"{left_out} scans whose features are not finite are left out")
                bar.update()
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    return paths


def _simulate_shard(shard: Path, path: Path, plan: ScanPlan) -> int:
    """Write the scans of one shard's scenes; return how many are not finite and left out."""
    rows, cards, left_out = [], [], 0
    with one_blas_thread():
        for scene in chain.from_iterable(whole.parts() for whole in load_shard(shard)):
            if not plan.takes(scene.environment):
                continue
            truth = scene.materials.dominant.ward
            ward = [*truth.rho_d, truth.rho_s, truth.alpha]
            for draw, rng in plan.draws(scene.index):
                features = simulated_scan(scene, draw, rng, plan.without)
                if features is None:
                    continue
                row = as_row(features)
                if not all(np.isfinite(array).all() for array in row.values()):
                    left_out += 1
                    continue
                rows.append(row)
                cards.append(ScanCard(ward, draw.views, scene.index, scene.environment))
    save_scans(path, rows, cards, plan.fingerprint(_scenes(shard)))
    return left_out


def _scenes(shard: Path) -> str:
    """The cards of a shard's scenes, as it holds them."""
    with safe_open(shard, framework="numpy") as file:
        return str((file.metadata() or {}).get("scenes"))
