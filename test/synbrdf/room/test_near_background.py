# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The background of scenes in rooms: where the object sees it, wherever the camera stands."""

import dataclasses

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from reflest_core.capture.frame import Frame
from reflest_core.fusion.frames.background_light import background_pixels
from reflest_core.light.light_map import LightMap
from reflest_core.synbrdf.generation.data_set import Generation
from reflest_core.synbrdf.path_tracing.sparse_scene import SparseRenderer, SparseSettings
from reflest_core.synbrdf.relit.scene_light import background_directions, scene_light
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.scene import Lighting
from reflest_core.synbrdf.scenes.splits import Split
from reflest_core.synbrdf.scenes.thumbnails import THUMBNAIL

GENERATION = Generation(1, {"train": 8}, views=12, lighting=Lighting.NEAR)


@pytest.fixture(scope="module")
def drawn():
    scenes = (GENERATION.scene(Split.TRAIN, index) for index in range(8))
    return next(scene for scene in scenes if scene.room.windows)


@pytest.fixture(scope="module")
def scene(drawn):
    return SparseRenderer(SparseSettings(40, 12, 16, 4)).render(drawn, 1)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def seen_at(thumbnails, view, point):
    """Pixel (row, column) at which a view sees a world point, and its depth; None if outside."""
    local = np.linalg.inv(thumbnails.T_world_camera[view]) @ [*point, 1.0]
    u = THUMBNAIL.fx * local[0] / local[2] + THUMBNAIL.cx
    v = THUMBNAIL.fy * local[1] / local[2] + THUMBNAIL.cy
    row, column = round(v), round(u)
    if local[2] <= 0 or not (0 <= row < THUMBNAIL.height and 0 <= column < THUMBNAIL.width):
        return None
    return row, column, local[2]


def test_a_wall_point_is_in_one_direction_from_the_object_for_all_cameras(scene):
    thumbnails = scene.thumbnails
    centre = scene.surface.positions.mean(axis=0)
    placed = unit(background_directions(thumbnails, centre))
    far = dataclasses.replace(thumbnails, depth=None)
    unplaced = unit(background_directions(far, centre))
    errors, errors_without_depth = [], []
    rows, columns = np.meshgrid(range(1, 36, 3), range(1, 48, 4), indexing="ij")
    for row, column in zip(rows.ravel(), columns.ravel(), strict=True):
        if thumbnails.is_object[0, row, column] or thumbnails.depth[0, row, column] == 0:
            continue
        pose = thumbnails.T_world_camera[0]
        ray = pose[:3, :3] @ [
            (column - THUMBNAIL.cx) / THUMBNAIL.fx,
            (row - THUMBNAIL.cy) / THUMBNAIL.fy,
            1.0,
        ]
        point = pose[:3, 3] + ray * thumbnails.depth[0, row, column] / 1000.0
        for view in range(1, 12):
            found = seen_at(thumbnails, view, point)
            if found is None:
                continue
            pixel = view, found[0], found[1]
            # The same wall, and not something before it.
            if abs(thumbnails.depth[pixel] / 1000.0 - found[2]) < 0.03:
                for directions, into in ((placed, errors), (unplaced, errors_without_depth)):
                    cosine = directions[0, row, column] @ directions[pixel]
                    into.append(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
    assert len(errors) > 20
    # Half a pixel's diagonal is a degree; from near walls it is more, seen from the object.
    assert np.median(errors) < 1.5
    assert np.quantile(errors, 0.95) < 5.0
    assert np.median(errors_without_depth) > 5.0 * np.median(errors)


def test_light_is_gathered_as_the_live_scan_gathers_it(scene):
    """The same images as frames of a depth camera, through the code of the live path."""
    thumbnails = scene.thumbnails
    centre = scene.surface.positions.mean(axis=0)
    images = expose(thumbnails.radiance(), scene.exposure)
    light, ours = LightMap(), LightMap()
    directions = background_directions(thumbnails, centre)
    for view, pose in enumerate(thumbnails.T_world_camera):
        depth = (thumbnails.depth[view] / 1000.0).astype(np.float32)
        frame = Frame(view, images[view], depth, pose.astype(np.float64), THUMBNAIL)
        nothing = np.zeros(depth.shape, np.bool_)
        live, colours = background_pixels(frame, nothing, depth, centre)
        np.testing.assert_allclose(live, directions[view].reshape(-1, 3), atol=1e-5)
        light.add(live, colours)
        ours.add(directions[view].reshape(-1, 3), images[view].reshape(-1, 3))
    # Rounding may move a pixel to the next texel.
    apart = np.abs(light.observed().radiance - ours.observed().radiance)
    assert (apart > 1e-6).mean() < 0.01
    assert scene_light(scene, np.arange(12)).seen_share > 0.1


def test_depth_ends_where_a_camera_stops_measuring(drawn, scene):
    depth = scene.thumbnails.depth
    assert depth.shape == (12, 36, 48)
    assert 0 < depth.max() <= 1000 * drawn.room.depth_reach
    assert (depth[scene.thumbnails.is_object] > 300).all()
    assert (depth[~scene.thumbnails.is_object] > 0).mean() > 0.5
    few = scene.thumbnails.of_views(np.array([3, 7]))
    np.testing.assert_array_equal(few.depth, depth[[3, 7]])
