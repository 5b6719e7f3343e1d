# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""All validation scenes at the voxels that HemiCNN looks at: a row of Table 2 in a few MB.

HemiCNN sees 25 voxels of a scene. Voxel choice on a surface that has these voxels alone returns
all of them, so that estimates from this file are bit for bit those from the whole data set.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.models.model_choice import MODELS
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.voxel_choice import choose_voxels
from reflest_core.training.data.sample import Sample
from reflest_core.training.data.sample_file import PER_OBSERVATION, PER_VOXEL, save_samples

QUICK_SET = Path(__file__).parent / "quick" / "validation.safetensors"
EXPECTED = QUICK_SET.with_name("expected.json")
VARIANT = "hemicnn-rmse1"


def save_quick_set(path: Path, samples: list[Sample]) -> None:
    """Write the scenes at HemiCNN's voxels."""
    count = MODELS["hemicnn"].voxels
    save_samples(
        path,
        [
            dataclasses.replace(
                sample, surface=keep_voxels(sample.surface, choose_voxels(sample.surface, count))
            )
            for sample in samples
        ],
    )


def keep_voxels(surface: ObservedSurface, voxels: NDArray[np.int64]) -> ObservedSurface:
    """The surface with only the voxels (N,) of the given indices."""
    counts = surface.observation_counts[voxels]
    offsets = np.concatenate([[0], np.cumsum(counts)])
    rows = np.repeat(surface.offsets[voxels] - offsets[:-1], counts) + np.arange(offsets[-1])
    return dataclasses.replace(
        surface,
        offsets=offsets,
        keys=None if surface.keys is None else surface.keys[voxels],
        **{name: getattr(surface, name)[voxels] for name in PER_VOXEL},
        **{name: getattr(surface, name)[rows] for name in PER_OBSERVATION},
    )
