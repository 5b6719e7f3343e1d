# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Exposing a rendered scene again."""

import dataclasses

import numpy as np

from reflest_core.light import rgbe
from reflest_core.synbrdf.scenes.exposure import auto_exposure, expose
from reflest_core.synbrdf.scenes.metering import Metering, object_exposure, remetered
from test.synbrdf.realism.sparse_scenes import ball_scene


def in_a_dark_room():
    """The object's pixels are a hundred times as bright as the walls."""
    scene = ball_scene()
    light = np.where(scene.thumbnails.is_object[..., None], 1.0, 0.01).astype(np.float32)
    images = np.broadcast_to(light, (*light.shape[:3], 3)).copy()
    thumbnails = dataclasses.replace(scene.thumbnails, rgbe=rgbe.encode(images))
    return dataclasses.replace(scene, thumbnails=thumbnails, exposure=auto_exposure(images))


def test_the_frame_is_how_a_scene_was_rendered():
    scene = in_a_dark_room()
    assert remetered(scene, Metering.FRAME) is scene


def test_an_object_in_a_dark_room_is_exposed_for_itself():
    scene = in_a_dark_room()
    assert scene.exposure > 0.9
    bright = scene.thumbnails.radiance()[scene.thumbnails.is_object]
    new = remetered(scene, Metering.OBJECT)
    # Everything there is as bright, so it becomes middle grey.
    np.testing.assert_allclose(new.exposure, 0.18 / bright.mean(), rtol=1e-3)
    assert new.exposure == object_exposure(scene.thumbnails)
    np.testing.assert_array_equal(
        new.surface.colours, expose(scene.radiance.astype(np.float32), new.exposure)
    )
    grey = expose(np.full((1, 3), 0.18, np.float32), 1.0)[0, 0]
    np.testing.assert_allclose(new.surface.view_foreground, grey, atol=0.6)
    assert (new.surface.view_background < scene.surface.view_background - 5).all()
    np.testing.assert_array_equal(new.radiance, scene.radiance)
