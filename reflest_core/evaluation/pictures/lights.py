# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Three environments that no training scene stood in, to look at materials under."""

from __future__ import annotations

from pathlib import Path

from reflest_core.evaluation.pictures.perception import Lights
from reflest_core.rendering.environments import studio
from reflest_core.synbrdf.generation.data_folder import read_manifest
from reflest_core.synbrdf.lights.environments import find_environments, load_environment
from reflest_core.synbrdf.lights.procedural_sky import procedural_sky
from reflest_core.synbrdf.scenes.splits import Split, sources_of

COUNT = 3
SKY_SEEDS = (900_001, 900_002)
"""Far from any seed of a data set's skies."""


def unseen_lights(data: Path, environments: Path | None) -> Lights:
    """Lat-long radiance by name: those of the unseen split, or without files invented ones.

    ``environments``: the file or folder that the data set in ``data`` was generated with.
    """
    if environments is None:
        skies = {f"sky {seed}": procedural_sky(seed) for seed in SKY_SEEDS}
        return {"studio": studio(), **skies}
    seed = int(read_manifest(data)["seed"])
    held_out = sources_of(Split.UNSEEN, find_environments(environments), [], seed).environments
    spread = [held_out[k * len(held_out) // COUNT] for k in range(min(COUNT, len(held_out)))]
    return {source.name: load_environment(source) for source in spread}
