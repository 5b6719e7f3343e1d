# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a depth camera sees of a room. Importing this module loads Mitsuba."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.path_tracing.mitsuba_scene import OBJECT, first_hits, first_shapes
from reflest_core.synbrdf.room.geometry import Room
from reflest_core.synbrdf.room.light_shapes import WINDOW


@dataclass(frozen=True)
class RoomSight:
    """What R rays meet.

    Attributes:
        depth: (R,) float64, metres along the optical axis; 0 where none is measured, which is in
            windows and beyond the camera's reach.
        is_object: (R,) bool.
    """

    depth: NDArray[np.float64]
    is_object: NDArray[np.bool_]

    @property
    def millimetres(self) -> NDArray[np.uint16]:
        """(R,) as depth images hold it."""
        return np.rint(1000.0 * self.depth).astype(np.uint16)


def room_sight(
    scene: Any,
    room: Room,
    origins: NDArray[np.float32],
    directions: NDArray[np.float32],
    forward: NDArray[np.floating],
) -> RoomSight:
    """Look along rays of cameras.

    Args:
        scene: the Mitsuba scene.
        room: the room that the object stands in.
        origins: (R, 3) metres.
        directions: (R, 3) unit, world frame.
        forward: (R, 3) optical axes, unit.
    """
    distance = first_hits(scene, origins, directions).astype(np.float64)
    shapes = first_shapes(scene, origins, directions)
    depth = distance * np.einsum("ij,ij->i", directions, forward)
    is_measured = np.isfinite(distance) & ~np.char.startswith(shapes, WINDOW)
    is_measured &= depth <= room.depth_reach
    return RoomSight(np.where(is_measured, depth, 0.0), shapes == OBJECT)
