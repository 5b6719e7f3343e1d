# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A floor of any size, filmed from above, for scans of a wanted number of voxels."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from benchmarks.scene.renderer import camera_of
from reflest_core.capture.frame import Frame
from reflest_core.fusion.settings import RegionSettings
from reflest_core.synbrdf.scenes.views import look_at

OVERVIEW_HEIGHT, OVERVIEW_SPACING = 1.5, 0.6
"""Metres; every point of the floor is seen from six positions or more."""
SMALL_HEIGHT = 0.3
"""Metres; such a frame sees 0.37 x 0.27 m."""
STRIP_STEP = 0.3
"""Metres, a sixth of what a frame sees."""
DOWN = np.array([0.0, 0.0, -1.0])


def floor_region(edge: float) -> RegionSettings:
    """A square region about the origin at z = 0.

    Args:
        edge: Metres.
    """
    return RegionSettings("box", (0.0, 0.0, 0.0), (edge, edge, 0.2))


def overview_frames(edge: float) -> Iterator[Frame]:
    """Frames from a square grid of positions above the whole floor.

    Args:
        edge: Edge of the floor, metres.
    """
    count = max(3, int(np.ceil(edge / OVERVIEW_SPACING)) + 1)
    reach = max(0.5 * edge, 0.6)
    places = np.linspace(-reach, reach, count)
    for number, (x, y) in enumerate((x, y) for x in places for y in places):
        yield _frame(np.array([x, y, OVERVIEW_HEIGHT]), number)


def small_frames(count: int) -> Iterator[Frame]:
    """Frames of the same small part, each from a new direction.

    Args:
        count: Number of frames.
    """
    for number in range(count):
        turn = 2.0 * np.pi * number / count
        centre = np.array([0.04 * np.cos(turn), 0.04 * np.sin(turn), SMALL_HEIGHT])
        yield _frame(centre, 100_000 + number)


def strip_frames(count: int) -> Iterator[Frame]:
    """Frames along a line over an endless floor: every one shows new surface.

    Args:
        count: Number of frames.
    """
    for number in range(count):
        yield _frame(np.array([STRIP_STEP * number, 0.0, OVERVIEW_HEIGHT]), number)


def _frame(centre: NDArray[np.float64], number: int) -> Frame:
    camera = camera_of(640, 480)
    pose = look_at(centre, centre + DOWN)
    v, u = np.mgrid[: camera.height, : camera.width]
    rgb = np.stack([u % 256, v % 256, np.full_like(u, 90)], axis=2).astype(np.uint8)
    depth = np.full((camera.height, camera.width), centre[2], np.float32)
    return Frame((number + 1) * 33_000_000, rgb, depth, pose, camera)
