# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What JPEG does to lone pixels of an object, by the codec itself on rendered images.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.path_tracing.scene_images import SceneImages
from reflest_core.synbrdf.realism.jpeg import compressed
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.splits import Split

TO_YCC = np.array([[0.299, 0.587, 0.114], [-0.168736, -0.331264, 0.5], [0.5, -0.418688, -0.081312]])
"""JFIF's luma and chroma of RGB."""


def jpeg_error(
    images: Iterable[tuple[NDArray[np.uint8], NDArray[np.bool_]]], quality: int
) -> NDArray[np.float64]:
    """Stddev (3,) of Y, Cb and Cr in 8-bit levels over the masked pixels of (image, mask) pairs.

    Args:
        images: 8-bit colour with masks.
        quality: of JPEG, 1 to 100.
    """
    errors = [
        (compressed(image, quality)[mask].astype(np.float64) - image[mask]) @ TO_YCC.T
        for image, mask in images
    ]
    return np.asarray(np.concatenate(errors).std(axis=0))


def rendered_images(
    generation: Generation, scenes: int, samples: int = 16
) -> list[tuple[NDArray[np.uint8], NDArray[np.bool_]]]:
    """One VGA image and its mask of each of the first training scenes.

    Args:
        generation: what the data set was asked to be.
        scenes: scenes to render.
        samples: paths of a pixel or an observation.
    """
    renderer = SceneImages(generation, 640, 480, samples)
    images = []
    for index in range(scenes):
        scene = generation.scene(Split.TRAIN, index)
        overview = renderer.overview(scene)
        image = renderer.render(scene, overview, generation.views // 10)
        images.append((expose(image.radiance, overview.exposure), image.is_object))
    return images
