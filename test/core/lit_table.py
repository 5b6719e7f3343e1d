# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Spheres on a table under a known map, rendered analytically: a scan of several materials."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reflest_core.brdf.srgb import encode
from reflest_core.light.light_map import LightMap
from reflest_core.light.octahedral import (
    octahedral_directions,
    octahedral_solid_angles,
    octahedral_texels,
)
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.surface.tangent_frame import tangent_frame

TABLE_HEIGHT = 0.0
LOBE_SAMPLES, DIFFUSE_SAMPLES = 24, 128


@dataclass(frozen=True)
class Material:
    rho_d: tuple[float, float, float]
    rho_s: float
    alpha: float


@dataclass(frozen=True)
class Ball:
    centre: tuple[float, float, float]
    radius: float


@dataclass(frozen=True)
class LitTable:
    """``labels``: (V,) true material of each voxel, the table's is 0. ``light``: (N, N, 3)."""

    surface: ObservedSurface
    labels: np.ndarray
    light: np.ndarray
    materials: tuple[Material, ...]


BALLS = (
    Ball((0.09, 0.0, 0.05), 0.05),
    Ball((-0.06, 0.08, 0.04), 0.04),
    Ball((-0.05, -0.08, 0.045), 0.045),
)
MATERIALS = (
    Material((0.30, 0.20, 0.12), 0.04, 0.12),
    Material((0.60, 0.08, 0.06), 0.05, 0.08),
    Material((0.05, 0.10, 0.40), 0.08, 0.15),
    Material((0.55, 0.55, 0.50), 0.03, 0.10),
)


def room_light(size=96, lamp=12.0):
    """A dim room with a bright window and a lamp overhead, which no camera of the orbit sees."""
    directions = octahedral_directions(size)
    floor = np.clip(-directions[..., 2], 0.0, 1.0)[..., None] * np.array([0.20, 0.15, 0.10])
    walls = 0.25 + 0.1 * np.sin(3.0 * np.arctan2(directions[..., 1], directions[..., 0]))
    light = floor + walls[..., None] * np.array([0.9, 0.95, 1.0])
    window = directions @ np.array([0.8, 0.3, 0.52]) > 0.95
    overhead = directions[..., 2] > 0.9
    light[window] = (2.5, 2.6, 3.0)
    light[overhead] = np.array([1.0, 0.9, 0.8]) * lamp
    return light.astype(np.float32)


def lit_table(
    voxel=0.01,
    views=16,
    table=0.16,
    materials=MATERIALS,
    balls=BALLS,
    light=None,
    seed=0,
    pattern=None,
):
    """Scan of ``balls`` on a table of half width ``table``; ``materials[0]`` is the table's.

    ``pattern``: takes table points (N, 2) to indices into ``materials``, for a textured table.
    """
    rng = np.random.default_rng(seed)
    light = room_light() if light is None else light
    positions, normals, labels = _points(voxel, table, balls, rng)
    if pattern is not None:
        on_table = labels == 0
        labels[on_table] = pattern(positions[on_table, :2])
    scene = _Scene(light, table, balls, materials, pattern)
    centres = _orbit(views)
    offsets, kept, view_indices, colours = [0], [], [], []
    diffuse = scene.diffuse(positions, normals, rng)
    for v in range(len(positions)):
        towards = centres - positions[v]
        distance = np.linalg.norm(towards, axis=1, keepdims=True)
        towards = towards / distance
        is_facing = towards @ normals[v] > 0.15
        seen = np.flatnonzero(is_facing)
        start = np.tile(positions[v] + 1e-4 * normals[v], (len(seen), 1))
        hit, _ = scene.hit(start, towards[seen])
        seen = seen[hit < 0]
        if len(seen) == 0:
            continue
        kept.append(v)
        offsets.append(offsets[-1] + len(seen))
        view_indices.append(seen)
        material = materials[labels[v]]
        gloss = scene.gloss(positions[v], normals[v], towards[seen], material, rng)
        colours.append(diffuse[v] * material.rho_d + material.rho_s * gloss)
    radiance = np.concatenate(colours)
    radiance *= 1.0 + 0.02 * rng.normal(size=(len(radiance), 1))
    eight_bit = np.rint(255.0 * encode(np.clip(radiance, 0.0, 1.0))).astype(np.uint8)
    surface = ObservedSurface(
        positions=positions[kept].astype(np.float32),
        normals=normals[kept].astype(np.float32),
        offsets=np.array(offsets, np.int64),
        colours=eight_bit,
        view_indices=np.concatenate(view_indices).astype(np.uint16),
        view_centres=centres.astype(np.float32),
        view_foreground=np.full((views, 3), 100.0, np.float32),
        view_background=np.full((views, 3), 100.0, np.float32),
        light=_background(scene, centres),
    )
    return LitTable(surface, labels[kept], light, tuple(materials))


class _Scene:
    """The light, and what stands in it."""

    def __init__(self, light, table, balls, materials, pattern):
        self.light, self.table, self.balls = light, table, balls
        self.materials, self.pattern = materials, pattern
        self.flat = light.reshape(-1, 3)
        self.normals = octahedral_directions(32).reshape(-1, 3)
        cosines = np.maximum(self.normals @ octahedral_directions(len(light)).reshape(-1, 3).T, 0.0)
        cosines *= octahedral_solid_angles(len(light)).reshape(-1)
        self.white = cosines @ self.flat / np.pi

    def hit(self, origins, directions):
        """What a ray meets first: -1 nothing, 0 the table, k the k-th ball; and where."""
        nearest = np.full(len(origins), np.inf)
        what = np.full(len(origins), -1)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (TABLE_HEIGHT - origins[:, 2]) / directions[:, 2]
            at = origins + t[:, None] * directions
            on_table = (t > 1e-5) & (np.abs(at[:, :2]) < self.table).all(axis=1)
        nearest[on_table], what[on_table] = t[on_table], 0
        for k, ball in enumerate(self.balls, 1):
            towards = origins - np.array(ball.centre)
            b = (towards * directions).sum(axis=1)
            square = b**2 - (towards**2).sum(axis=1) + ball.radius**2
            t = -b - np.sqrt(np.maximum(square, 0.0))
            meets = (square > 0.0) & (t > 1e-5) & (t < nearest)
            nearest[meets], what[meets] = t[meets], k
        return what, origins + np.where(what < 0, 0.0, nearest)[:, None] * directions

    def arriving(self, origins, directions):
        """(R, 3): the light along rays; where they meet something, one bounce in the open light."""
        what, places = self.hit(origins, directions)
        radiance = self.flat[octahedral_texels(directions, len(self.light))]
        normals = np.tile([0.0, 0.0, 1.0], (len(origins), 1))
        for k, ball in enumerate(self.balls, 1):
            normals[what == k] = (places[what == k] - ball.centre) / ball.radius
        white = self.white[octahedral_texels(normals, 32)]
        for k in range(len(self.balls) + 1):
            radiance[what == k] = white[what == k] * self.materials[k].rho_d
        return radiance

    def diffuse(self, positions, normals, rng):
        """(V, 3): ``E / pi``."""
        n = DIFFUSE_SAMPLES
        sums = np.zeros((len(positions), 3))
        for _ in range(n):
            d = rng.normal(size=(len(positions), 3))
            d = normals + d / np.linalg.norm(d, axis=1, keepdims=True)
            d /= np.linalg.norm(d, axis=1, keepdims=True)
            sums += self.arriving(positions + 1e-4 * normals, d)
        return sums / n

    def gloss(self, position, normal, towards, material, rng):
        """(W, 3): what is mirrored towards cameras at ``rho_s = 1``."""
        tx, ty, tz, bx, by, bz = tangent_frame(normal)
        frame = np.array([[tx, ty, tz], [bx, by, bz], normal])
        u, phi = (
            (np.arange(LOBE_SAMPLES) + 0.5) / LOBE_SAMPLES,
            rng.random(LOBE_SAMPLES) * 2 * np.pi,
        )
        theta = np.arctan(material.alpha * np.sqrt(-np.log(1.0 - u)))
        half = np.stack(
            [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], 1
        )
        half = half @ frame
        along = towards @ half.T
        into = 2.0 * along[..., None] * half - towards[:, None]
        cos_i, cos_o = into @ normal, np.maximum(towards @ normal, 1e-3)[:, None]
        weight = along * np.cos(theta) ** 3 * np.sqrt(np.maximum(cos_i, 0.0) / cos_o)
        weight *= (along > 0.0) & (cos_i > 0.0)
        flat = into.reshape(-1, 3)
        light = self.arriving(np.tile(position + 1e-4 * normal, (len(flat), 1)), flat)
        return (weight[..., None] * light.reshape(*weight.shape, 3)).mean(axis=1)


def _points(voxel, table, balls, rng):
    """About one point for each voxel of the surface that can be seen."""
    steps = np.arange(-table, table, voxel) + voxel / 2
    x, y = (grid.ravel() for grid in np.meshgrid(steps, steps))
    positions = [np.stack([x, y, np.zeros_like(x)], axis=1)]
    normals = [np.tile([0.0, 0.0, 1.0], (len(x), 1))]
    labels = [np.zeros(len(x), np.int64)]
    for k, ball in enumerate(balls, 1):
        count = int(4.0 * np.pi * ball.radius**2 / voxel**2)
        n = np.arange(count) + 0.5
        height, turn = 1.0 - 2.0 * n / count, np.pi * (1.0 + 5.0**0.5) * n
        ring = np.sqrt(1.0 - height**2)
        unit = np.stack([ring * np.cos(turn), ring * np.sin(turn), height], axis=1)
        positions.append(np.array(ball.centre) + ball.radius * unit)
        normals.append(unit)
        labels.append(np.full(count, k))
    order = rng.permutation(sum(map(len, labels)))
    return (np.concatenate(parts)[order] for parts in (positions, normals, labels))


def _orbit(views):
    turn = 2.0 * np.pi * np.arange(views) / views
    height = np.radians(30.0 + 20.0 * np.sin(3.0 * turn))
    return 0.6 * np.stack(
        [np.cos(turn) * np.cos(height), np.sin(turn) * np.cos(height), np.sin(height)], axis=1
    )


def _background(scene, centres):
    """The light as cameras that look at the table's middle see it past the table."""
    light = LightMap()
    u, v = (
        grid.ravel() for grid in np.meshgrid(np.linspace(-0.8, 0.8, 80), np.linspace(-0.6, 0.6, 60))
    )
    for centre in centres:
        forward = -centre / np.linalg.norm(centre)
        right = np.cross(forward, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        down = np.cross(forward, right)
        rays = forward + u[:, None] * right + v[:, None] * down
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        rays = rays[scene.hit(np.tile(centre, (len(rays), 1)), rays)[0] < 0]
        radiance = scene.flat[octahedral_texels(rays, len(scene.light))]
        eight_bit = np.rint(255.0 * encode(np.clip(radiance, 0.0, 1.0))).astype(np.uint8)
        light.add(rays.astype(np.float32), eight_bit)
    return light.observed()
