# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Rooms from seeds: they hold every camera, hide nothing from it, and are never dark."""

import numpy as np
import pytest

from reflest_core.synbrdf.lights.environments import procedural_skies
from reflest_core.synbrdf.lights.procedural_sky import procedural_sky
from reflest_core.synbrdf.room.draw import DEPTH_REACHES, draw_room
from reflest_core.synbrdf.room.furnishing import Stage
from reflest_core.synbrdf.room.geometry import ATLAS_TILES, Box
from reflest_core.synbrdf.room.paint import draw_paint
from reflest_core.synbrdf.scenes.scene import Lighting, draw_scene
from reflest_core.synbrdf.scenes.splits import Sources, Split
from reflest_core.synbrdf.scenes.views import draw_views
from test.synbrdf.spheres import icosphere

SKY = procedural_sky(0, 32)
BALL = icosphere(2, 0.15)


def drawn(seed):
    rng = np.random.default_rng(seed)
    poses, _ = draw_views(rng, 40, BALL.diameter)
    return poses, draw_room(rng, BALL, poses, SKY)


def distances(panel, origins, directions):
    """Along rays (R, 3) to where they meet a panel; infinity where they do not."""
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (panel.corner - origins) @ panel.normal / (directions @ panel.normal)
        offset = origins + along[:, None] * directions - panel.corner
        u, v = (offset @ edge / (edge @ edge) for edge in (panel.across, panel.up))
        is_hit = (along > 0) & (u >= 0) & (u <= 1) & (v >= 0) & (v <= 1)
    return np.where(is_hit, along, np.inf)


@pytest.mark.parametrize("seed", range(20))
def test_a_room_holds_the_cameras_and_hides_nothing_from_them(seed):
    poses, room = drawn(seed)
    centres = poses[:, :3, 3]
    for surface in room.surfaces[:6]:
        # Walls face inwards, and every camera and the whole object are before them.
        assert ((centres - surface.panel.corner) @ surface.panel.normal > 0.1).all()
        assert -surface.panel.corner @ surface.panel.normal > BALL.diameter / 2
    panels = [part.panel for part in (*room.surfaces, *room.lamps, *room.windows)]
    for panel in panels:
        # Nothing is met on the way to the object, which fills the last of it.
        assert (distances(panel, centres, -centres) > 0.85).all()
    assert len(room.surfaces) <= ATLAS_TILES
    assert room.lamps or room.globes or room.windows
    assert DEPTH_REACHES[0] <= room.depth_reach <= DEPTH_REACHES[1]


def test_equal_seeds_give_equal_rooms_and_others_differ():
    (_, one), (_, again), (_, other) = drawn(3), drawn(3), drawn(4)
    for first, second in zip(one.surfaces, again.surfaces, strict=True):
        np.testing.assert_array_equal(first.panel.corner, second.panel.corner)
        np.testing.assert_array_equal(first.albedo, second.albedo)
    assert not np.array_equal(one.surfaces[0].albedo, other.surfaces[0].albedo)


def test_rooms_have_all_kinds_of_light_and_furniture():
    rooms = [drawn(seed)[1] for seed in range(40)]
    assert {len(room.windows) for room in rooms} >= {0, 1, 2}
    assert {len(room.globes) for room in rooms} >= {0, 1}
    assert {len(room.lamps) for room in rooms} >= {0, 1, 2}
    assert np.ptp([len(room.surfaces) for room in rooms]) > 10


def test_a_box_has_its_faces_where_they_belong():
    box = Box(np.array([0.0, -1.0, 2.0]), np.array([0.5, 1.0, 3.0]))
    outwards = [-np.eye(3)[0], np.eye(3)[0], -np.eye(3)[1], np.eye(3)[1], -np.eye(3)[2]]
    for face, inner, normal in zip(box.outside, box.inside, [*outwards, np.eye(3)[2]], strict=True):
        np.testing.assert_allclose(face.normal, normal, atol=1e-12)
        np.testing.assert_allclose(inner.normal, -normal, atol=1e-12)
        np.testing.assert_allclose(face.middle, inner.middle, atol=1e-12)
        middle = 0.5 * (box.low + box.high)
        half = 0.5 * (box.high - box.low)
        np.testing.assert_allclose(face.middle, middle + normal * half, atol=1e-12)
        np.testing.assert_allclose(face.grid(3, 5)[1, 2], face.middle, atol=1e-12)


def test_what_stands_in_a_view_is_not_clear():
    stage = Stage(np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), 0.2, -0.2)
    size = np.full(3, 0.1)
    for place, is_clear in (
        ([0.6, -0.05, -0.05], False),
        ([0.1, 0.1, 0.0], False),
        ([0.6, 0.6, -0.05], True),
        ([0.6, -0.05, -0.3], True),
    ):
        low = np.array(place)
        assert stage.is_clear(Box(low, low + size)) is is_clear


@pytest.mark.parametrize("seed", range(8))
def test_paint_reflects_less_than_it_receives(seed):
    paint = draw_paint(np.random.default_rng(seed), (0.03, 0.85), 0.3)
    assert paint.min() >= 0.01
    assert paint.max() <= 0.9


def test_every_split_stands_in_rooms_with_its_own_view_outside():
    sources = Sources(procedural_skies(3), [])
    for split in Split:
        scenes = [draw_scene(1, split, k, sources, 5, Lighting.NEAR) for k in range(6)]
        for scene in scenes:
            assert scene.room is not None
            names = scene.light.name.split("+")
            assert names[0] == "room"
            assert (len(names) > 1) == bool(scene.room.windows)
            assert set(names[1:]) <= {source.name for source in sources.environments}
        natural = draw_scene(1, split, 0, sources, 5)
        assert natural.room is None
        dominant = scenes[0].painted.dominant
        assert natural.painted.dominant != dominant
        assert draw_scene(1, split, 0, sources, 5, Lighting.NEAR).painted.dominant == dominant
