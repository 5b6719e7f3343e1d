# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Full images of scenes in rooms show what their thumbnails show."""

import cv2
import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.path_tracing.scene_images import SceneImages
from reflest_core.synbrdf.scenes.scene import Lighting
from reflest_core.synbrdf.scenes.splits import Split

GENERATION = Generation(1, {"train": 4}, views=6, lighting=Lighting.NEAR)


def test_colour_depth_and_mask_are_those_of_the_thumbnail():
    scene = GENERATION.scene(Split.TRAIN, 1)
    # Smaller than 640 x 480 only in pixels: thumbnails have the same field of view.
    images = SceneImages(GENERATION, 96, 72, 16)
    overview = images.overview(scene)
    image = images.render(scene, overview, 2)
    thumbnails = overview.thumbnails
    small = cv2.resize(image.radiance, (48, 36), interpolation=cv2.INTER_AREA)
    shown = thumbnails.radiance()[2]
    assert np.median(np.abs(small - shown) / (shown + 1e-3)) < 0.03
    mask = cv2.resize(image.is_object.astype(np.float32), (48, 36), interpolation=cv2.INTER_AREA)
    assert np.abs(mask - thumbnails.is_object[2]).mean() < 0.03
    depth, seen = image.depth[::2, ::2], thumbnails.depth[2] / 1000.0
    both = (depth > 0) & (seen > 0)
    assert both.mean() > 0.5
    assert np.median(np.abs(depth - seen)[both]) < 0.03
    assert image.depth.max() <= scene.room.depth_reach
    assert (image.depth > 0).sum() > 3 * image.is_object.sum()
