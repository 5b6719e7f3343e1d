# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Light in a room, against integrals and a radiosity solution in numpy."""

import dataclasses

import numpy as np
import pytest

from reflest_core.brdf.parameters import WardParameters
from reflest_core.synbrdf.room.geometry import Box, Globe, Panel, PanelLight, Room, Surface, even
from reflest_core.synbrdf.room.paint import TEXELS
from test.synbrdf.spheres import icosphere

room_scene = pytest.importorskip("reflest_core.synbrdf.room.room_scene")
mitsuba_scene = pytest.importorskip("reflest_core.synbrdf.path_tracing.mitsuba_scene")
ward_bsdf = pytest.importorskip("reflest_core.synbrdf.path_tracing.ward_bsdf").ward_bsdf
depth_view = pytest.importorskip("reflest_core.synbrdf.room.depth_view")

BOX = Box(np.array([-1.0, -1.3, -0.6]), np.array([1.5, 1.1, 1.2]))
BLACK = np.full((TEXELS, TEXELS, 3), 1e-6, np.float32)
RADIANCE = np.array([9.0, 6.0, 3.0])
LAMP = Panel(np.array([0.2, -0.4, 1.1]), np.array([0.0, 0.7, 0.0]), np.array([0.5, 0.0, 0.0]))
ALBEDO = (0.6, 0.3, 0.1)
RADIUS = 0.15
BALL = icosphere(5, RADIUS)


def room(albedos, **changes):
    surfaces = [Surface(p, a, 0.16) for p, a in zip(BOX.inside, albedos, strict=True)]
    lamps = [PanelLight(LAMP, even(RADIANCE))]
    return dataclasses.replace(Room(surfaces, lamps, [], [], 8.0), **changes)


def scene_of(a_room, mesh=BALL):
    bsdf = ward_bsdf(WardParameters(ALBEDO, 0.0, 0.1))
    return room_scene.RoomBuilder().scene(mesh, bsdf, a_room, seed=1)


def received(points, normals, panel, radiance, cells=60):
    """Irradiance (P, 3) at ``points`` from an even panel: the sum over its cells."""
    spots = panel.grid(cells, cells).reshape(-1, 3)
    apart = spots - points[:, None]
    distance = np.linalg.norm(apart, axis=-1)
    towards = apart / distance[..., None]
    cosines = np.maximum(np.einsum("psk,pk->ps", towards, normals), 0.0)
    cosines *= np.maximum(-towards @ panel.normal, 0.0)
    return (cosines / distance**2).sum(axis=1)[:, None] * radiance * panel.area / cells**2


def upper_points(count, lowest):
    """Unit normals of places on the ball that see all of the lamp."""
    normals = np.random.default_rng(2).normal(size=(count, 3))
    normals[:, 2] = np.abs(normals[:, 2]) + lowest
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def test_a_ball_under_a_lamp_in_a_black_room_shows_the_integral():
    normals = upper_points(40, 1.5)
    points = RADIUS * normals
    tracer = mitsuba_scene.RadianceTracer(256, lanes=1 << 14)
    origins = (points + 0.5 * normals).astype(np.float32)
    traced = tracer.trace(scene_of(room([BLACK] * 6)), origins, -normals.astype(np.float32), 3)
    light = received(points, normals, LAMP, RADIANCE)
    np.testing.assert_allclose(traced, light * ALBEDO / np.pi, rtol=0.02)
    # The lamp is near: were it as far as the ball is small, equal normals would be lit alike.
    far = received(np.zeros((40, 3)), normals, LAMP, RADIANCE)
    assert np.abs(far / light - 1.0).max() > 0.2


def test_a_globe_sends_what_a_sphere_sends():
    """Irradiance of a ball of radius r at distance d, all above the horizon: L pi (r/d)^2 cos."""
    globe = Globe(np.array([0.3, 0.2, 0.8]), 0.1, RADIANCE)
    normals = upper_points(20, 2.0)
    points = RADIUS * normals
    tracer = mitsuba_scene.RadianceTracer(1024, lanes=1 << 15)
    traced = tracer.trace(
        scene_of(room([BLACK] * 6, lamps=[], globes=[globe])),
        (points + 0.4 * normals).astype(np.float32),
        -normals.astype(np.float32),
        3,
    )
    apart = globe.centre - points
    distance = np.linalg.norm(apart, axis=1)
    cosine = np.einsum("ij,ij->i", apart, normals) / distance
    irradiance = np.pi * (globe.radius / distance) ** 2 * cosine
    np.testing.assert_allclose(traced, irradiance[:, None] * RADIANCE * ALBEDO / np.pi, rtol=0.02)


def test_walls_send_the_light_of_a_radiosity_solution():
    """Painted walls, an empty box, lamp and all reflections between the walls.

    The paint differs along both edges of a wall, so that a mirrored or turned texture fails.
    """
    v, u = np.meshgrid(*[(np.arange(TEXELS) + 0.5) / TEXELS] * 2, indexing="ij")
    paint = np.stack([0.1 + 0.7 * u, 0.1 + 0.7 * v, np.full(u.shape, 0.5)], -1).astype(np.float32)
    a_room = room([paint] * 6)
    tiny = icosphere(2, 0.005)
    scene = scene_of(a_room, tiny)
    cells = 14
    points = np.concatenate([s.panel.grid(cells, cells).reshape(-1, 3) for s in a_room.surfaces])
    normals = np.repeat([s.panel.normal for s in a_room.surfaces], cells**2, axis=0)
    areas = np.repeat([s.panel.area / cells**2 for s in a_room.surfaces], cells**2)
    v, u = np.meshgrid(*[(np.arange(cells) + 0.5) / cells] * 2, indexing="ij")
    albedo = np.tile(
        np.stack([0.1 + 0.7 * u, 0.1 + 0.7 * v, 0.5 + 0 * u], -1).reshape(-1, 3), (6, 1)
    )
    apart = points[None] - points[:, None]
    squared = (apart**2).sum(axis=-1) + np.eye(len(points))
    leaving = np.maximum(np.einsum("ijk,ik->ij", apart, normals), 0.0)
    arriving = np.maximum(-np.einsum("ijk,jk->ij", apart, normals), 0.0)
    exchange = leaving * arriving / squared**2 * areas / np.pi
    # Cells that share an edge are too near for one point each: every row must sum to 1.
    exchange /= exchange.sum(axis=1, keepdims=True)
    direct = received(points, normals, LAMP, RADIANCE)
    total = direct
    for _ in range(room_scene.BAKE_DEPTH - 2):
        total = direct + exchange @ (albedo * total)
    expected = albedo * total / np.pi
    # The back of the lamp hides the ceiling above it from the rest; look at walls and floor.
    chosen = np.arange(5 * cells**2)
    origins = (points + 0.02 * normals)[chosen].astype(np.float32)
    tracer = mitsuba_scene.RadianceTracer(4, lanes=1 << 13)
    found = tracer.trace(scene, origins, -normals[chosen].astype(np.float32), 5)
    error = found / expected[chosen] - 1.0
    assert abs(np.median(error)) < 0.02
    assert np.quantile(np.abs(error), 0.9) < 0.12
    # More than the lamp alone sends.
    assert total[chosen].sum() > 1.3 * direct[chosen].sum()


def test_depth_cameras_see_walls_but_neither_windows_nor_what_is_far():
    pane = Panel(np.array([1.49, -0.3, 0.2]), np.array([0.0, 0.6, 0.0]), np.array([0.0, 0.0, 0.5]))
    pane = Panel(pane.corner + pane.across, -pane.across, pane.up)
    window = PanelLight(pane, even(np.ones(3)))
    a_room = room([BLACK] * 6, windows=[window], depth_reach=1.05)
    scene = scene_of(a_room)
    origins = np.tile(np.array([0.6, 0.0, 0.0], np.float32), (4, 1))
    targets = np.array([[1.5, 0.0, 0.45], [1.5, 0.5, 0.0], [0.0, 0.0, 0.0], [0.6, -1.3, 0.0]])
    directions = targets - origins
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    forward = np.array([[1.0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, -1, 0]])
    sight = depth_view.room_sight(scene, a_room, origins, directions.astype(np.float32), forward)
    np.testing.assert_array_equal(sight.is_object, [False, False, True, False])
    np.testing.assert_allclose(sight.depth, [0.0, 0.9, 0.6 - RADIUS, 0.0], atol=2e-3)
    assert sight.millimetres.tolist()[0] == 0
