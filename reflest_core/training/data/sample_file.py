# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scenes as training sees them in one file, end to end: a twelfth of the data set's bytes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.training.data.sample import Sample, TrainingError
from reflest_core.whole_file import write_whole

FORMAT = "reflest-samples-1"
PER_VOXEL = ("positions", "normals")
PER_OBSERVATION = ("colours", "view_indices")
PER_VIEW = ("view_centres", "view_foreground", "view_background")
ARRAYS = PER_VOXEL + PER_OBSERVATION + PER_VIEW


def save_samples(path: Path, samples: list[Sample]) -> None:
    """Write samples, whole or not at all, without the light in their background.

    Args:
        path: Of the file.
        samples: The scenes, in order.
    """
    surfaces = [sample.surface for sample in samples]
    arrays = {name: np.concatenate([getattr(s, name) for s in surfaces]) for name in ARRAYS}
    counts = np.concatenate([surface.observation_counts for surface in surfaces])
    arrays["observation_counts"] = counts.astype(np.uint16)
    arrays["ward"] = np.stack([sample.ward for sample in samples])
    layout = {
        "voxels": [surface.voxel_count for surface in surfaces],
        "views": [len(surface.view_centres) for surface in surfaces],
        "environments": [sample.environment for sample in samples],
        "indices": [sample.index for sample in samples],
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, save(arrays, {"format": FORMAT, "layout": json.dumps(layout)}))


def read_samples(path: Path) -> list[Sample]:
    """Read the file of :func:`save_samples`.

    Args:
        path: Of the file.

    Raises:
        TrainingError: The file is damaged or of another format.
    """
    try:
        with safe_open(path, framework="numpy") as file:
            metadata = file.metadata() or {}
            if metadata.get("format") != FORMAT:
                raise TrainingError(f"{path} is not a {FORMAT} file; write it again")
            layout = json.loads(metadata["layout"])
            arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (SafetensorError, OSError) as error:
        raise TrainingError(f"{path} is damaged ({error}); get or write it again") from error
    first_voxel, first_view = _starts(layout["voxels"]), _starts(layout["views"])
    rows = _starts(arrays["observation_counts"])
    samples = []
    for number, (environment, index) in enumerate(
        zip(layout["environments"], layout["indices"], strict=True)
    ):
        voxels = slice(first_voxel[number], first_voxel[number + 1])
        views = slice(first_view[number], first_view[number + 1])
        offsets = rows[voxels.start : voxels.stop + 1]
        seen = slice(offsets[0], offsets[-1])
        parts = {name: arrays[name][voxels] for name in PER_VOXEL}
        parts |= {name: arrays[name][seen] for name in PER_OBSERVATION}
        parts |= {name: arrays[name][views] for name in PER_VIEW}
        surface = ObservedSurface(offsets=offsets - offsets[0], **parts)
        samples.append(Sample(surface, arrays["ward"][number], environment, index))
    return samples


def _starts(counts: Any) -> NDArray[np.int64]:
    return np.concatenate([[0], np.cumsum(np.asarray(counts, np.int64))])
