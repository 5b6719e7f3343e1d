# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Lamps and windows of a room."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.light.equirectangular import radiance_from
from reflest_core.synbrdf.room.furnishing import Stage
from reflest_core.synbrdf.room.geometry import (
    LIGHT_TEXELS,
    MOST_GLOBES,
    MOST_LAMPS,
    MOST_WINDOWS,
    Box,
    FloatArray,
    Globe,
    Panel,
    PanelLight,
    even,
)

OFF_WALL = 0.01
"""Metres by which windows and ceiling lamps stand off what they are fixed to."""


def draw_ceiling_lamps(rng: np.random.Generator, room: Box) -> list[PanelLight]:
    """One to four alike panels under the ceiling.

    Args:
        rng: random numbers; the same state draws the same.
        room: inside of the room.
    """
    span = room.high - room.low
    edges = np.minimum(rng.uniform([0.15, 0.15], [0.6, 1.5]), 0.5 * span[:2])
    edges = edges if rng.uniform() < 0.5 else np.minimum(edges[::-1], 0.5 * span[:2])
    radiance = _white(rng) * np.exp(rng.uniform(np.log(20.0), np.log(250.0)))
    lamps = []
    for _ in range(int(rng.integers(1, MOST_LAMPS))):
        near = room.low[:2] + rng.uniform(0.05, 0.95, 2) * (span[:2] - edges)
        corner = np.array([*near, room.high[2] - OFF_WALL])
        across, up = np.array([0.0, edges[1], 0.0]), np.array([edges[0], 0.0, 0.0])
        lamps.append(PanelLight(Panel(corner, across, up), even(radiance)))
    return lamps


def draw_globes(rng: np.random.Generator, room: Box, stage: Stage) -> list[Globe]:
    """Up to two balls of light, where they hide nothing.

    Args:
        rng: random numbers; the same state draws the same.
        room: inside of the room.
        stage: what stands in the room so far.
    """
    globes = []
    for _ in range(int(rng.integers(1, MOST_GLOBES + 1))):
        radius = rng.uniform(0.04, 0.2)
        centre = room.low + radius + rng.uniform(size=3) * (room.high - room.low - 2.0 * radius)
        radiance = _white(rng) * np.exp(rng.uniform(np.log(20.0), np.log(400.0)))
        if centre[2] > 0.0 and stage.is_clear(Box(centre - radius, centre + radius)):
            globes.append(Globe(centre, radius, radiance))
    return globes


def draw_softbox(rng: np.random.Generator, room: Box, stage: Stage) -> list[PanelLight]:
    """A photographer's large lamp that faces the object; none where it finds no place.

    Args:
        rng: random numbers; the same state draws the same.
        room: inside of the room.
        stage: what stands in the room so far.
    """
    azimuth, elevation = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.0, 1.1)
    towards = np.array(
        [
            np.cos(azimuth) * np.cos(elevation),
            np.sin(azimuth) * np.cos(elevation),
            np.sin(elevation),
        ]
    )
    across = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0]) * rng.uniform(0.3, 1.0)
    up = -np.cross(towards, across / np.linalg.norm(across)) * rng.uniform(0.3, 1.0)
    if np.cross(across, up) @ towards > 0.0:
        across = -across
    middle = towards * rng.uniform(0.8, 2.5)
    panel = Panel(middle - 0.5 * (across + up), across, up)
    corners = panel.corner + np.array([np.zeros(3), across, up, across + up])
    box = Box(corners.min(axis=0), corners.max(axis=0))
    is_within = (box.low > room.low).all() and (box.high < room.high).all()
    if not is_within or not stage.is_clear(box):
        return []
    radiance = _white(rng) * np.exp(rng.uniform(np.log(5.0), np.log(60.0)))
    return [PanelLight(panel, even(radiance))]


def draw_window_panels(rng: np.random.Generator, room: Box) -> list[Panel]:
    """One to three panes in the walls.

    Args:
        rng: random numbers; the same state draws the same.
        room: inside of the room.
    """
    panels = []
    for side in rng.permutation(4)[: int(rng.integers(1, MOST_WINDOWS + 1))]:
        wall = room.inside[int(side)]
        width, height = np.linalg.norm(wall.across), np.linalg.norm(wall.up)
        share = np.minimum(rng.uniform([0.5, 0.5], [2.0, 1.8]) / [width, height], 0.8)
        left, low = rng.uniform(0.05, 0.95, 2) * (1.0 - share)
        corner = wall.corner + left * wall.across + low * wall.up + OFF_WALL * wall.normal
        panels.append(Panel(corner, share[0] * wall.across, share[1] * wall.up))
    return panels


def window(rng: np.random.Generator, panel: Panel, outside: NDArray[np.float32]) -> PanelLight:
    """Make a pane that shows an environment, as the origin sees it.

    Args:
        rng: random numbers; the same state draws the same.
        panel: the rectangle, world frame.
        outside: (H, 2 H, 3) environment, equirectangular.
    """
    towards = panel.grid(LIGHT_TEXELS, LIGHT_TEXELS).reshape(-1, 3)
    towards = towards / np.linalg.norm(towards, axis=1, keepdims=True)
    seen = radiance_from(outside, towards.astype(np.float32)) / np.float32(outside.mean())
    brightness = np.exp(rng.uniform(np.log(3.0), np.log(60.0)))
    shape = (LIGHT_TEXELS, LIGHT_TEXELS, 3)
    return PanelLight(panel, np.asarray(seen * brightness + 1e-3, np.float32).reshape(shape))


def _white(rng: np.random.Generator) -> FloatArray:
    """From a warm bulb to a cold tube, of mean about 1."""
    warmth = rng.uniform(-0.25, 0.6)
    return np.exp(np.array([0.5, 0.0, -0.9]) * warmth + rng.normal(0.0, 0.04, 3))
