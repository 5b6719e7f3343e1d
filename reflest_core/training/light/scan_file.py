# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The simulated scans of one shard's scenes in a file: float16 arrays, and a card of each scan."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from reflest_core.models.lightnet import VOXELS
from reflest_core.models.lightnet.features import LightFeatures
from reflest_core.training.data.sample import TrainingError
from reflest_core.whole_file import write_whole

AXES = {
    "is_seen": "VO",
    "apparent": "VOC",
    "clipped": "VOC",
    "cosine": "VO",
    "lobe": "VOKC",
    "lobe_seen": "VOK",
    "lobe_clipped": "VOK",
    "normals": "VD",
    "diffuse_light": "VC",
    "diffuse_seen": "V",
    "diffuse_clipped": "V",
    "voxel_fit": "VCKF",
    "scene_fit": "CKF",
    "zones": "ZR",
    "channel_statistics": "CF",
    "statistics": "F",
    "found_albedo": "CF",
    "found_gloss": "F",
    "gloss_evidence": "F",
    "gloss_answers": "F",
}
"""The arrays of ``LightFeatures`` by their axes: how they are padded, thinned and varied.

V voxels, O observations of one voxel, C colour channels, K roughnesses, D a direction in the
world, F results of a fit, Z rings of elevation, R three colour channels and then shares."""
FORMAT = "reflest-scans-1"
LARGEST = 6e4
"""Near the largest float16; only ratios to no light at all come there."""


@dataclass(frozen=True)
class ScanCard:
    """What is known of a simulated scan.

    Attributes:
        ward: The true ``rho_d`` (3), ``rho_s``, ``alpha``.
        views: How many.
        scene: Index of its scene in the split.
        environment: Name of its light.
    """

    ward: list[float]
    views: int
    scene: int
    environment: str


def as_row(features: LightFeatures) -> dict[str, NDArray[Any]]:
    """Make the arrays of a scan as they are stored: float16, padded to an estimate's voxels.

    Args:
        features: Of one scan.
    """
    row = {}
    for name, axes in AXES.items():
        array = getattr(features, name)
        if axes[0] == "V":
            padding = [(0, VOXELS - len(array))] + [(0, 0)] * (array.ndim - 1)
            array = np.pad(array, padding)
        is_flag = array.dtype == np.bool_
        row[name] = array if is_flag else np.clip(array, -LARGEST, LARGEST).astype(np.float16)
    return row


def save_scans(
    path: Path, rows: list[dict[str, NDArray[Any]]], cards: list[ScanCard], fingerprint: str
) -> None:
    """Write simulated scans, whole or not at all.

    Args:
        path: Of the file.
        rows: Of :func:`as_row`; there may be none.
        cards: One for each row.
        fingerprint: Of the plan, the code and the scenes.

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


def read_cards(path: Path, fingerprint: str | None = None) -> list[ScanCard]:
    """Read the cards without the arrays.

    Args:
        path: Of the file.
        fingerprint: That the file must have; None takes any.

    Raises:
        TrainingError: The file is damaged or has another fingerprint.
    """
    with _opened(path) as file:
        metadata = file.metadata() or {}
    if metadata.get("format") != FORMAT or (
        fingerprint is not None and metadata["fingerprint"] != fingerprint
    ):
        raise TrainingError(
            f"{path} was made by other code, with other settings or of other scenes; delete "
            f"{path.parent} or choose another --scan-folder"
        )
    return [ScanCard(**card) for card in json.loads(metadata["looks"])]


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """Read the arrays of a file with at least one scan.

    Args:
        path: Of the file.
    """
    with _opened(path) as file:
        return {name: file.get_tensor(name) for name in AXES}


def _opened(path: Path) -> Any:
    try:
        return safe_open(path, framework="numpy")
    except (SafetensorError, OSError) as error:
        raise TrainingError(f"{path} is damaged ({error}); delete it to make it again") from error
