# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Generating the sparse data set: shards come back from workers and are written here."""

from __future__ import annotations

import json
from concurrent.futures import Executor
from contextlib import AbstractContextManager, closing
from functools import partial
from pathlib import Path
from typing import Any

from tqdm import tqdm

from reflest_core.synbrdf.generation.data_folder import begin_manifest, write_json
from reflest_core.synbrdf.generation.data_set import Generation, ShardTask, shard_tasks
from reflest_core.synbrdf.generation.shard_rendering import render_shard
from reflest_core.synbrdf.generation.shard_workers import WorkerError, finished
from reflest_core.synbrdf.scenes.scene_file import (
    MANIFEST,
    SceneFileError,
    sha256,
)
from reflest_core.whole_file import write_whole


def generate(
    folder: Path, generation: Generation, workers: AbstractContextManager[Executor]
) -> None:
    """Write every shard that is not there yet, then the manifest with the hashes of all.

    Only this process writes, each file whole: a killed run leaves whole shards, and the same call
    goes on and ends with the same bytes, by any kind of workers.

    Args:
        folder: to write into.
        generation: the data set.
        workers: processes or a cluster, as a context.
    """
    generation.check_extra()
    manifest = generation.manifest()
    begin_manifest(folder, manifest)
    _check_hashes(folder)
    tasks = list(shard_tasks(generation))
    missing = [task for task in tasks if not (folder / task.file_name).exists()]
    scenes = sum(task.scenes for task in tasks)
    done = scenes - sum(task.scenes for task in missing)
    # Closed at once when writing fails, so that what nobody will take is not rendered.
    with (
        tqdm(total=scenes, initial=done, unit="scene") as progress,
        closing(finished(workers, partial(render_agreed, generation, manifest), missing)) as shards,
    ):
        for task, shard in shards:
            write_whole(folder / task.file_name, shard)
            progress.update(task.scenes)
    hashes = {task.file_name: sha256(folder / task.file_name) for task in tasks}
    write_json(folder / MANIFEST, {**manifest, "sha256": hashes})


def render_agreed(generation: Generation, manifest: dict[str, Any], task: ShardTask) -> bytes:
    """Render a shard, where code, libraries and sources are those of the manifest.

    Args:
        generation: the data set.
        manifest: what the data set is and which code made it.
        task: one shard.

    Returns:
        The shard's bytes.

    Raises:
        WorkerError: This worker differs from the manifest.
    """
    own = generation.manifest()
    differing = sorted(key for key in manifest if own.get(key) != manifest[key])
    if differing:
        raise WorkerError(
            f"a worker has another {', '.join(differing)}: install the same reflest on every "
            "machine, and put the same --environments and --meshes at the same paths"
        )
    return render_shard(generation, task)


def _check_hashes(folder: Path) -> None:
    """What a finished run wrote must still be that."""
    for name, digest in json.loads((folder / MANIFEST).read_text()).get("sha256", {}).items():
        path = folder / name
        if path.exists() and sha256(path) != digest:
            raise SceneFileError(
                f"{path} is damaged: its hash is not the manifest's; delete it and generate again"
            )
