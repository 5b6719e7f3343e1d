# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the full images of a scene are: a row of pictures for each.

Colour, the same three stops darker (the HDR image), depth, normals, mask, and colour and depth with
realism. Importing this module loads Mitsuba.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.path_tracing.scene_images import SceneImages
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.splits import Split

TILE = (200, 150)
"""Pixels, width and height."""
RENDERED = (640, 480)
DARKER = 0.125


def image_strip(
    generation: Generation, split: Split, indices: list[int], view: int, samples: int = 16
) -> NDArray[np.uint8]:
    """Draw a row of images for each scene.

    Args:
        generation: the data set, which must have realism.
        split: train, validation or unseen.
        indices: of the scenes.
        view: index of the view.
        samples: paths of a pixel.

    Returns:
        8-bit sRGB image.
    """
    images = SceneImages(generation, *RENDERED, samples)
    rows = [_row(images, split, index, view) for index in indices]
    return np.concatenate(rows)


def _row(images: SceneImages, split: Split, index: int, view: int) -> NDArray[np.uint8]:
    scene = images.generation.scene(split, index)
    overview = images.overview(scene)
    image = images.render(scene, overview, view)
    faults, noise = images.faults(scene, overview)
    assert faults is not None
    known = image.depth[image.depth > 0.0]
    reach = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    measured = faults.depth(image.depth, image.cosines, images.camera, noise[view])
    tiles = [
        expose(image.radiance, overview.exposure),
        expose(image.radiance, overview.exposure * DARKER),
        _grey(image.depth, reach),
        np.rint(127.5 * (image.normals + 1.0)).astype(np.uint8),
        np.where(image.is_object[..., None], np.uint8(255), np.zeros(3, np.uint8)),
        faults.image(image.radiance, overview.exposure, view, noise[view]),
        _grey(measured, reach),
    ]
    small = [cv2.resize(tile, TILE, interpolation=cv2.INTER_AREA) for tile in tiles]
    return np.concatenate(small, axis=1).astype(np.uint8)


def _grey(depth: NDArray[np.float32], reach: tuple[float, float]) -> NDArray[np.uint8]:
    """Near is bright; black where unknown."""
    share = (reach[1] - depth) / max(reach[1] - reach[0], 1e-3)
    grey = np.where(depth > 0.0, 60 + 195 * np.clip(share, 0.0, 1.0), 0.0)
    return np.repeat(grey.astype(np.uint8)[..., None], 3, axis=-1)
