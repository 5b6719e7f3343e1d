# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scene rendered again is the scene that was generated, seen from nearer by."""

import dataclasses
import json

import cv2
import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.pictures.close_ups import HEIGHT, WIDTH, CloseUps, close_up
from reflest_core.evaluation.pictures.failure_pictures import fullest_view, thumbnail_picture
from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.path_tracing.sparse_scene import SparseRenderer, SparseSettings
from reflest_core.synbrdf.scenes.splits import Split
from reflest_core.synbrdf.scenes.thumbnails import THUMBNAIL

GENERATION = Generation(3, {"train": 4, "validation": 2, "unseen": 2}, points=40, views=6)


@pytest.fixture(scope="module")
def close_ups(tmp_path_factory):
    data = tmp_path_factory.mktemp("data")
    (data / "manifest.json").write_text(json.dumps(GENERATION.manifest()))
    return CloseUps(data, None, None)


@pytest.fixture(scope="module")
def scene():
    renderer = SparseRenderer(SparseSettings(points=40, views=6))
    return renderer.render(GENERATION.scene(Split.UNSEEN, 1), GENERATION.seed)


def place_in_thumbnail(camera, column, row):
    """Where a pixel of the close-up's camera lies in the thumbnail: the same ray."""
    x, y = (column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy
    return THUMBNAIL.cx + THUMBNAIL.fx * x, THUMBNAIL.cy + THUMBNAIL.fy * y


def test_the_object_is_in_the_middle_and_nearly_fills_the_picture():
    is_object = np.zeros((36, 48), bool)
    is_object[10:16, 20:28] = True
    camera = close_up(is_object)
    middle = place_in_thumbnail(camera, (WIDTH - 1) / 2, (HEIGHT - 1) / 2)
    np.testing.assert_allclose(middle, (23.5, 12.5))
    left, _ = place_in_thumbnail(camera, -0.5, 0)
    right, _ = place_in_thumbnail(camera, WIDTH - 0.5, 0)
    assert right - left == pytest.approx(1.5 * 8)


def test_the_picture_shows_what_the_thumbnail_shows(close_ups, scene):
    view = fullest_view(scene)
    picture = close_ups.picture(scene, view)
    assert picture.shape == (HEIGHT, WIDTH, 3)
    camera = close_up(scene.thumbnails.is_object[view])
    left, top = place_in_thumbnail(camera, -0.5, -0.5)
    right, bottom = place_in_thumbnail(camera, WIDTH - 0.5, HEIGHT - 0.5)
    small = thumbnail_picture(scene, view)
    columns = np.arange(max(int(np.ceil(left + 0.5)), 0), min(int(right - 0.5), 47) + 1)
    rows = np.arange(max(int(np.ceil(top + 0.5)), 0), min(int(bottom - 0.5), 35) + 1)
    # Where each thumbnail pixel lies in the close-up, whose pixels are averaged over it.
    scale = camera.fx / THUMBNAIL.fx
    x = camera.cx + (columns - THUMBNAIL.cx) * scale
    y = camera.cy + (rows - THUMBNAIL.cy) * scale
    blurred = cv2.blur(picture, (max(int(scale), 1),) * 2)
    seen = blurred[np.rint(y).astype(int)][:, np.rint(x).astype(int)]
    expected = small[rows][:, columns]
    assert np.abs(seen - expected).mean() < 0.05
    assert np.corrcoef(seen.ravel(), expected.ravel())[0, 1] > 0.9


def test_other_sources_are_refused(close_ups, scene):
    other = dataclasses.replace(scene, environment="another")
    with pytest.raises(EvaluationError, match="cannot be drawn again"):
        close_ups.picture(other, 0)
