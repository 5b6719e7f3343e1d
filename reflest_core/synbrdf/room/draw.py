# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A room from a seed, built about the views of an object that are already drawn."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from reflest_core.surface.upright import rotation_about_z
from reflest_core.synbrdf.room.furnishing import (
    Stage,
    draw_furniture,
    draw_table,
    draw_walls,
    painted,
)
from reflest_core.synbrdf.room.geometry import FloatArray, Globe, Room
from reflest_core.synbrdf.room.lighting import (
    draw_ceiling_lamps,
    draw_globes,
    draw_softbox,
    draw_window_panels,
    window,
)
from reflest_core.synbrdf.shapes.mesh import TriangleMesh

WINDOW_SHARE, CEILING_SHARE, GLOBE_SHARE, SOFTBOX_SHARE = 0.6, 0.65, 0.35, 0.25
"""Of rooms have such light; a room that would have none has ceiling lamps."""
DEPTH_REACHES = (3.5, 8.0)
"""Metres to which depth cameras measure."""


def draw_room(
    rng: np.random.Generator,
    mesh: TriangleMesh,
    poses: FloatArray,
    outside: NDArray[np.float32],
    has_table: bool = True,
) -> Room:
    """Draw a room about an object, with every camera in it; world frame.

    Args:
        rng: Source of the draw.
        mesh: The object.
        poses: ``T_world_camera`` (W, 4, 4).
        outside: Lat-long map (H, 2 H, 3), what windows show.
        has_table: Whether there may be a table under the object.
    """
    rotation = rotation_about_z(rng.uniform(0.0, 2.0 * np.pi))
    stage = Stage(poses[:, :3, 3] @ rotation, 0.5 * mesh.diameter, float(mesh.vertices[:, 2].min()))
    box = draw_walls(rng, stage)
    walls, table = painted(rng, box), draw_table(rng, box, stage)
    surfaces = walls + (table if has_table else []) + draw_furniture(rng, box, stage)
    panes = draw_window_panels(rng, box) if rng.uniform() < WINDOW_SHARE else []
    globes = draw_globes(rng, box, stage) if rng.uniform() < GLOBE_SHARE else []
    lamps = draw_softbox(rng, box, stage) if rng.uniform() < SOFTBOX_SHARE else []
    if rng.uniform() < CEILING_SHARE or not (panes or globes or lamps):
        lamps += draw_ceiling_lamps(rng, box)
    return Room(
        surfaces=[dataclasses.replace(s, panel=s.panel.turned(rotation)) for s in surfaces],
        lamps=[dataclasses.replace(lamp, panel=lamp.panel.turned(rotation)) for lamp in lamps],
        globes=[Globe(rotation @ globe.centre, globe.radius, globe.radiance) for globe in globes],
        windows=[window(rng, pane.turned(rotation), outside) for pane in panes],
        depth_reach=float(rng.uniform(*DEPTH_REACHES)),
    )
