# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Rendering one shard, in whichever process it is asked for."""

from __future__ import annotations

import dataclasses
import threading
from functools import cache
from typing import TYPE_CHECKING

from reflest_core.synbrdf.generation.data_set import Generation, ShardTask
from reflest_core.synbrdf.realism.degrade import degrade
from reflest_core.synbrdf.realism.settings import Realism
from reflest_core.synbrdf.scenes.metering import remetered
from reflest_core.synbrdf.scenes.scene_file import shard_bytes
from reflest_core.synbrdf.scenes.seeding import Purpose, generator
from reflest_core.synbrdf.scenes.surface_points import SurfaceKind

if TYPE_CHECKING:
    from reflest_core.synbrdf.path_tracing.sparse_scene import SparseRenderer

_renderer_in_use = threading.Lock()


def render_shard(generation: Generation, task: ShardTask) -> bytes:
    """The bytes of a shard's file: the same for the same arguments, in any process or thread.

    Args:
        generation: what the data set was asked to be.
        task: one shard.
    """
    scenes = []
    for index in range(task.first, task.last):
        scene = generation.scene(task.split, index)
        # A Dask worker may run tasks in threads; the renderer serves one at a time.
        with _renderer_in_use:
            renderer = _renderer(
                generation.points,
                generation.views,
                generation.samples,
                generation.surface,
                generation.realism,
            )
            seen = renderer.render(scene, generation.seed)
        seen = remetered(seen, generation.metering)
        if generation.realism is not None:
            rng = generator(generation.seed, task.split, index, Purpose.REALISM)
            seen = degrade(seen, _left_to_do(generation.realism, generation.surface), rng)
        scenes.append(seen)
    return shard_bytes(scenes)


def _left_to_do(realism: Realism, surface: SurfaceKind) -> Realism:
    """Fused voxels have the faults of depth already."""
    if surface is SurfaceKind.EXACT:
        return realism
    return dataclasses.replace(realism, depth_noise=0.0, depth_holes=0.0, normal_noise=0.0)


@cache
def _renderer(
    points: int, views: int, samples: int, surface: SurfaceKind, realism: Realism | None
) -> SparseRenderer:
    """One renderer a process: its kernels compile once."""
    from reflest_core.synbrdf.path_tracing.sparse_scene import SparseRenderer, SparseSettings

    settings = SparseSettings(points, views, samples, surface=surface, realism=realism)
    return SparseRenderer(settings)
