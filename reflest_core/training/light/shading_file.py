# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The looks at one shard's scenes in a file: float16 arrays, and a card of each look."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from reflest_core.models.lightnet.shading import Shading
from reflest_core.models.model_choice import MODELS
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.light.shading_axes import AXES
from reflest_core.whole_file import write_whole

FORMAT = "reflest-shadings-1"
LARGEST = 6e4
"""Near the largest float16; only ratios to no light at all come there."""


@dataclass(frozen=True)
class LookCard:
    """``ward``: the truth. ``views``: how many. ``scene``: its index. ``environment``: name."""

    ward: list[float]
    views: int
    scene: int
    environment: str


def as_row(look: Shading) -> dict[str, NDArray[Any]]:
    """The arrays of a look as stored: padded to as many voxels as an estimate takes, float16."""
    voxels = MODELS["lightnet"].voxels
    row = {}
    for name, axes in AXES.items():
        array = getattr(look, name)
        if axes[0] == "V":
            padding = [(0, voxels - len(array))] + [(0, 0)] * (array.ndim - 1)
            array = np.pad(array, padding)
        is_flag = array.dtype == np.bool_
        row[name] = array if is_flag else np.clip(array, -LARGEST, LARGEST).astype(np.float16)
    return row


def save_looks(
    path: Path, rows: list[dict[str, NDArray[Any]]], cards: list[LookCard], fingerprint: str
) -> None:
    """Write them whole or not at all; there may be none.

    Raises:
        OutputError: The file cannot be written.
    """
    arrays = {name: np.stack([row[name] for row in rows]) for name in AXES} if rows else {}
    metadata = {
        "format": FORMAT,
        "fingerprint": fingerprint,
        "looks": json.dumps([asdict(card) for card in cards]),
    }
    write_whole(path, save(arrays, metadata))


def read_cards(path: Path, fingerprint: str | None = None) -> list[LookCard]:
    """The cards, without the arrays; :class:`TrainingError` unless the file is of ``fingerprint``.

    None takes any.
    """
    with _opened(path) as file:
        metadata = file.metadata() or {}
    if metadata.get("format") != FORMAT or (
        fingerprint is not None and metadata["fingerprint"] != fingerprint
    ):
        raise TrainingError(
            f"{path} was made by other code, with other settings or of other scenes; delete "
            f"{path.parent} or choose another --shadings"
        )
    return [LookCard(**card) for card in json.loads(metadata["looks"])]


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of a file with at least one look."""
    with _opened(path) as file:
        return {name: file.get_tensor(name) for name in AXES}


def _opened(path: Path) -> Any:
    try:
        return safe_open(path, framework="numpy")
    except (SafetensorError, OSError) as error:
        raise TrainingError(f"{path} is damaged ({error}); delete it to make it again") from error
