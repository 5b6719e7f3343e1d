# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Walls, a table under the object, and furniture where no camera looks through it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reflest_core.synbrdf.room.geometry import Box, FloatArray, Surface
from reflest_core.synbrdf.room.paint import draw_paint

CAMERA_MARGIN = 0.15
"""Metres from a camera to the nearest wall."""
SIGHT_MARGIN = 0.04
"""Metres from furniture to any line of sight."""
WALL_DISTANCES = (0.5, 4.5)
"""Metres from the object to a wall, where the cameras leave room for it."""
TABLE_SHARE = 0.65
"""Of rooms where no camera looks from below have a table under the object."""
TABLE_GAP = 1e-3
"""Metres between the object and the table, so that neither cuts through the other."""
WALL_TEXEL, FURNITURE_TEXEL, TABLE_TEXEL = 0.16, 0.16, 0.05
MOST_BOXES = 8


@dataclass(frozen=True)
class Stage:
    """What a room must leave clear, in its own axes: the object at the origin, and all views of it.

    Attributes:
        cameras: (W, 3) metres.
        radius: Of the ball that holds the object, metres.
        bottom: The object's lowest z, metres.
    """

    cameras: FloatArray
    radius: float
    bottom: float

    def is_clear(self, box: Box) -> bool:
        """Whether a box keeps off the object and stands in no view of it.

        Args:
            box: in the room's axes.
        """
        nearest = np.clip(np.zeros(3), box.low, box.high)
        if np.linalg.norm(nearest) < self.radius + SIGHT_MARGIN:
            return False
        along = np.linspace(0.05, 1.0, 40)[:, None, None]
        return not box.holds((along * self.cameras).reshape(-1, 3), SIGHT_MARGIN)


def draw_walls(rng: np.random.Generator, stage: Stage) -> Box:
    """The room's inside, with every camera in it.

    Args:
        rng: random numbers; the same state draws the same.
        stage: what stands in the room so far.
    """
    reach_low = -stage.cameras.min(axis=0) + CAMERA_MARGIN
    reach_high = stage.cameras.max(axis=0) + CAMERA_MARGIN
    nearest, farthest = np.log(WALL_DISTANCES)
    low, high = (np.exp(rng.uniform(nearest, farthest, 3)) for _ in range(2))
    low[2], high[2] = rng.uniform(0.3, 1.2), rng.uniform(1.2, 2.8)
    clear = stage.radius + CAMERA_MARGIN
    return Box(
        -np.maximum(np.maximum(low, reach_low), clear),
        np.maximum(np.maximum(high, reach_high), clear),
    )


def painted(rng: np.random.Generator, room: Box) -> list[Surface]:
    """Four walls of one or two paints, a floor, a bright ceiling.

    Args:
        rng: random numbers; the same state draws the same.
        room: inside of the room.
    """
    kinds = [((0.15, 0.85), 0.2)] * 4 + [((0.05, 0.6), 0.25), ((0.6, 0.9), 0.05)]
    paints = [draw_paint(rng, brightness, chroma) for brightness, chroma in kinds]
    if rng.uniform() < 0.6:
        paints[1:4] = [paints[0]] * 3 if rng.uniform() < 0.5 else [paints[0], *paints[2:4]]
    return [
        Surface(panel, paint, WALL_TEXEL) for panel, paint in zip(room.inside, paints, strict=True)
    ]


def draw_table(rng: np.random.Generator, room: Box, stage: Stage) -> list[Surface]:
    """A table or counter that the object stands on; none where a camera is below its top.

    Args:
        rng: random numbers; the same state draws the same.
        room: inside of the room.
        stage: what stands in the room so far.
    """
    top = stage.bottom - TABLE_GAP
    has_table = rng.uniform() < TABLE_SHARE
    if not has_table or stage.cameras[:, 2].min() < top + 0.02 or room.low[2] > top - 0.1:
        return []
    half = np.array([*np.maximum(rng.uniform(0.2, 0.9, 2), 0.6 * stage.radius), 0.0])
    aside = np.array([*rng.uniform(-0.4, 0.4, 2) * half[:2], top])
    floor, paint = np.array([0.0, 0.0, room.low[2] - top]), draw_paint(rng, (0.03, 0.85), 0.3)
    is_counter = rng.uniform() < 0.5
    slab = floor if is_counter else np.array([0.0, 0.0, -0.04])
    inside = room.low + 1e-3, room.high - 1e-3
    low, high = (np.clip(aside + edge, *inside) for edge in (slab - half, half))
    high[2] = top
    boxes = [(Box(low, high), [0, 1, 2, 3, 5] if is_counter else [0, 1, 2, 3, 4, 5])]
    if not is_counter:
        leg = np.array([0.05, 0.05, 0.0])
        middle = 0.5 * (low + high)
        foot, end = middle.copy(), middle.copy()
        foot[2], end[2] = room.low[2], low[2]
        boxes.append((Box(foot - leg, end + leg), [0, 1, 2, 3]))
    return [
        Surface(box.outside[face], paint, TABLE_TEXEL if face == 5 else FURNITURE_TEXEL)
        for box, faces in boxes
        for face in faces
    ]


def draw_furniture(rng: np.random.Generator, room: Box, stage: Stage) -> list[Surface]:
    """Painted boxes on the floor, most of them along the walls.

    Args:
        rng: random numbers; the same state draws the same.
        room: inside of the room.
        stage: what stands in the room so far.
    """
    surfaces = []
    for _ in range(int(rng.integers(2, MOST_BOXES + 1))):
        size = rng.uniform([0.3, 0.3, 0.3], [1.8, 1.2, 2.2])
        size[:2] = size[:2] if rng.uniform() < 0.5 else size[1::-1]
        size = np.minimum(size, 0.9 * (room.high - room.low))
        low = room.low + rng.uniform(size=3) * (room.high - room.low - size)
        low[2] = room.low[2]
        if rng.uniform() < 0.7:
            side, axis = rng.uniform() < 0.5, int(rng.integers(2))
            low[axis] = room.low[axis] if side else room.high[axis] - size[axis]
        box, paint = Box(low, low + size), draw_paint(rng, (0.03, 0.8), 0.4)
        if stage.is_clear(box):
            faces = [box.outside[face] for face in (0, 1, 2, 3, 5)]
            surfaces += [Surface(face, paint, FURNITURE_TEXEL) for face in faces]
    return surfaces
