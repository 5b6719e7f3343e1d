# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Many scenes at a glance, as the paper's Figure 5: first views, some with their depth.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.path_tracing.scene_images import SceneImages
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.splits import Split

TILE = (120, 90)
"""Pixels, width and height."""
RENDERED = 2
"""Times as large as they are shown, for smooth outlines."""
INSET_EVERY, INSET_SHARE = 3, 0.4


def contact_sheet(
    generation: Generation, split: Split, rows: int, columns: int, samples: int = 16
) -> NDArray[np.uint8]:
    """Draw the first views of scenes, taken evenly from a split; every third with its depth map.

    Args:
        generation: the data set.
        split: train, validation or unseen.
        rows: of the picture.
        columns: of the picture.
        samples: paths of a pixel.

    Returns:
        8-bit sRGB image; in depth maps near is bright.
    """
    count = generation.scenes[split.value]
    indices = np.linspace(0, count - 1, min(rows * columns, count)).round().astype(int)
    images = SceneImages(generation, TILE[0] * RENDERED, TILE[1] * RENDERED, samples)
    sheet = np.full((rows * TILE[1], columns * TILE[0], 3), 255, np.uint8)
    for place, index in enumerate(tqdm(indices.tolist(), unit="scene")):
        scene = generation.scene(split, index)
        overview = images.overview(scene)
        image = images.render(scene, overview, view=0)
        shown = expose(image.radiance, overview.exposure)
        tile = np.asarray(cv2.resize(shown, TILE, interpolation=cv2.INTER_AREA), np.uint8)
        if place % INSET_EVERY == 0:
            _inset(tile, image.depth)
        row, column = divmod(place, columns)
        top, left = row * TILE[1], column * TILE[0]
        sheet[top : top + TILE[1], left : left + TILE[0]] = tile
    return sheet


def _inset(tile: NDArray[np.uint8], depth: NDArray[np.float32]) -> None:
    size = int(TILE[0] * INSET_SHARE), int(TILE[1] * INSET_SHARE)
    small = cv2.resize(depth, size, interpolation=cv2.INTER_NEAREST)
    known = small[small > 0]
    grey = np.zeros(small.shape, np.uint8)
    if known.size:
        share = (known.max() - small) / max(float(np.ptp(known)), 1e-3)
        grey = np.where(small > 0, 60 + 195 * np.clip(share, 0, 1), 0).astype(np.uint8)
    tile[: size[1], : size[0]] = grey[..., None]
