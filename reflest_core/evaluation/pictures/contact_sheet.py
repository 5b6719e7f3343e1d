# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A sheet of pictures: the truth and every network's estimate, material by material."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.pictures.rendered_shapes import SIZE
from reflest_core.evaluation.pictures.swatches import Swatch
from reflest_core.training.data.sample import Sample

SHOWN = 5
"""Materials on the sheet."""
INCHES = 0.9
"""Edge of a picture."""


def draw_contact_sheet(
    path: Path,
    swatches: list[Swatch],
    samples: list[Sample],
    estimates: dict[str, NDArray[np.float64]],
) -> None:
    """Write a PNG with a row for the truth and each network, two columns for each material.

    Each material is shown on the sphere under the first environment and on the bumpy sphere under a
    point light.

    Args:
        path: The file to write.
        swatches: Result of :func:`.prepare_swatches`.
        samples: The scenes to show.
        estimates: (S, 5) Ward parameters of these scenes, by network.

    Raises:
        EvaluationError: matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise EvaluationError(
            "plots need matplotlib: pip install 'reflest-ros[training]'"
        ) from error
    pair = (swatches[0], swatches[-4])
    rows = {"truth": np.stack([sample.ward for sample in samples]), **estimates}
    sheet = np.concatenate(
        [
            np.concatenate([swatch.picture(ward) for ward in wards for swatch in pair], axis=1)
            for wards in rows.values()
        ]
    )
    size = INCHES * 2 * len(samples) + 1.6, INCHES * len(rows) + 0.3
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots()
    axes.imshow(np.clip(sheet, 0, 1), interpolation="lanczos")
    axes.set_yticks([SIZE * (row + 0.5) for row in range(len(rows))], list(rows), fontsize=8)
    places = [SIZE * (2 * column + 1) for column in range(len(samples))]
    axes.set_xticks(places, [f"v{sample.index}" for sample in samples], fontsize=8)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    figure.savefig(path, dpi=130, bbox_inches="tight")
