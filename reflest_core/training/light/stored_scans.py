# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Many simulated scans in memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.training.data.sample import TrainingError
from reflest_core.training.light.scan_file import ScanCard, read_arrays, read_cards


@dataclass(frozen=True)
class StoredScans:
    """L simulated scans.

    Attributes:
        arrays: Those of ``LightFeatures`` with a leading L, float16.
        ward: (L, 5) float32, the truth.
        views: (L,), how many each has.
        scene: (L,), index of each one's scene in its split.
        environment: (L,), name of each one's light.
    """

    arrays: Mapping[str, NDArray[Any]]
    ward: NDArray[np.float32]
    views: NDArray[np.int64]
    scene: NDArray[np.int64]
    environment: NDArray[np.str_]

    def __len__(self) -> int:
        return len(self.ward)


def load_scans(
    paths: list[Path], is_wanted: Callable[[ScanCard], bool] = lambda card: True
) -> StoredScans:
    """Load scans, in no more memory than they take.

    Args:
        paths: Files, in order.
        is_wanted: Whether a scan is loaded, by its card.

    Raises:
        TrainingError: None is wanted.
    """
    files = [(path, read_cards(path)) for path in paths]
    kept = [np.array([is_wanted(card) for card in cards], np.bool_) for _, cards in files]
    total = sum(int(mask.sum()) for mask in kept)
    if not total:
        raise TrainingError("there is no scene to scan: give more data or hold out less of it")
    arrays: dict[str, NDArray[Any]] = {}
    filled = 0
    for (path, _), mask in zip(files, kept, strict=True):
        count = int(mask.sum())
        if not count:
            continue
        for name, array in read_arrays(path).items():
            if name not in arrays:
                arrays[name] = np.empty((total, *array.shape[1:]), array.dtype)
            arrays[name][filled : filled + count] = array[mask]
        filled += count
    cards = [
        card
        for (_, some), mask in zip(files, kept, strict=True)
        for card, is_kept in zip(some, mask, strict=True)
        if is_kept
    ]
    return StoredScans(
        arrays,
        np.array([card.ward for card in cards], np.float32),
        np.array([card.views for card in cards]),
        np.array([card.scene for card in cards]),
        np.array([card.environment for card in cards]),
    )
