# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A room's lamps and windows as Mitsuba holds them. Importing this module loads Mitsuba."""

from __future__ import annotations

import math
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.lab import luminance
from reflest_core.synbrdf.room.geometry import (
    MOST_GLOBES,
    MOST_LAMPS,
    MOST_WINDOWS,
    Globe,
    Panel,
    PanelLight,
    Room,
    even,
)
from reflest_core.synbrdf.room.glow import glow
from reflest_core.synbrdf.room.textured_mesh import textured_mesh
from reflest_core.synbrdf.shapes.mesh import grid_faces

Part = TypeVar("Part")
LAMP, GLOBE, WINDOW = "lamp", "globe", "window"
LEAST_SHARE = 0.1
"""Of an even share of shadow rays, for lamps that hardly reach the object."""
DARK_SHARE = 1e-6
"""Of the weight of the faintest light, for what is dark."""
OUTSIDE = np.array([0.0, 0.0, -100.0])
RINGS, SECTORS = 16, 24
"""Of a globe's mesh."""


def light_shapes(room: Room) -> dict[str, Any]:
    """Shapes that shine, aimed at by shadow rays as their light reaches the object.

    As many for every room, or each room would compile kernels of its own: those that a room does
    not have are dark, and outside.

    Args:
        room: the room that the object stands in.
    """
    panels = _named(LAMP, _filled(room.lamps, MOST_LAMPS))
    panels |= _named(WINDOW, _filled(room.windows, MOST_WINDOWS))
    dark = [Globe(OUTSIDE, 0.1, np.zeros(3))] * (MOST_GLOBES - len(room.globes))
    globes = _named(GLOBE, room.globes + dark)
    reach = {name: _panel_reach(panel) for name, panel in panels.items()}
    reach |= {name: _globe_reach(globe) for name, globe in globes.items()}
    least = LEAST_SHARE * sum(reach.values()) / sum(value > 0.0 for value in reach.values())
    weight = {
        name: max(value, least) if value > 0.0 else DARK_SHARE * least
        for name, value in reach.items()
    }
    shapes = {name: _panel_shape(panel, weight[name]) for name, panel in panels.items()}
    return shapes | {name: _globe_shape(globe, weight[name]) for name, globe in globes.items()}


def _named(kind: str, parts: list[Part]) -> dict[str, Part]:
    return {f"{kind}-{number}": part for number, part in enumerate(parts)}


def _filled(lights: list[PanelLight], count: int) -> list[PanelLight]:
    panel = Panel(OUTSIDE, np.array([0.1, 0.0, 0.0]), np.array([0.0, 0.1, 0.0]))
    return lights + [PanelLight(panel, even(np.zeros(3)))] * (count - len(lights))


def _panel_shape(light: PanelLight, weight: float) -> Any:
    places = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    panel = light.panel
    vertices = panel.corner + places @ np.stack([panel.across, panel.up])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    return textured_mesh(vertices, places, faces, emitter=glow(light.radiance, weight))


def _globe_shape(globe: Globe, weight: float) -> Any:
    polar = np.linspace(0.0, np.pi, RINGS)[:, None]
    azimuth = 2.0 * np.pi * np.arange(SECTORS) / SECTORS
    around = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
    ball = np.concatenate(
        [np.sin(polar)[..., None] * around, np.repeat(np.cos(polar)[..., None], SECTORS, axis=1)],
        axis=-1,
    ).reshape(-1, 3)
    # The flat faces lie within the ball: as large as its surface is, so that its light is.
    faces = grid_faces(RINGS, SECTORS, wrap_rows=False, wrap_columns=True)
    a, b, c = (ball[faces[:, corner]] for corner in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    vertices = globe.centre + globe.radius * math.sqrt(4.0 * math.pi / area) * ball
    places = np.full((len(ball), 2), 0.5)
    return textured_mesh(vertices, places, faces, emitter=glow(even(globe.radiance), weight))


def _panel_reach(light: PanelLight) -> float:
    middle = light.panel.middle
    distance = float(np.linalg.norm(middle))
    cosine = abs(float(light.panel.normal @ middle)) / distance
    return _brightness(light.radiance.reshape(-1, 3)) * light.panel.area * cosine / distance**2


def _globe_reach(globe: Globe) -> float:
    share = math.pi * globe.radius**2 / float(globe.centre @ globe.centre)
    return _brightness(globe.radiance[None]) * share


def _brightness(radiance: NDArray[np.floating]) -> float:
    return float(luminance(radiance.astype(np.float64)).mean())
