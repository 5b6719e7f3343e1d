# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An object in a room as Mitsuba holds it. Importing this module loads Mitsuba.

The room's walls and furniture are matte, so that each point of them sends the same light
everywhere: it is computed once for a scene (with the object in its place, its shadow and its
colour), and paths that meet a wall afterwards end there.
"""

from __future__ import annotations

import math
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.path_tracing.mitsuba_scene import OBJECT, RadianceTracer, mi, mitsuba_mesh
from reflest_core.synbrdf.path_tracing.ward_bsdf import WardBSDF
from reflest_core.synbrdf.room.atlas import atlas, panel_mesh, spread
from reflest_core.synbrdf.room.geometry import Room, Surface
from reflest_core.synbrdf.room.glow import glow, texture
from reflest_core.synbrdf.room.light_shapes import light_shapes
from reflest_core.synbrdf.room.textured_mesh import textured_mesh
from reflest_core.synbrdf.shapes.mesh import TriangleMesh

BAKE_DEPTH = 8
"""Mitsuba's ``max_depth`` of the light on the walls."""
BAKE_SAMPLES = 64
SMOOTHING = 0.7
"""Texels, Gaussian: the noise of the light on a wall would else look like another paint."""
ABOVE = 1e-3
"""Metres over a wall from which it is looked at."""
WALLS = "walls"


class RoomBuilder:
    """Makes scenes of rooms one after another with one set of kernels."""

    def __init__(self, samples: int = BAKE_SAMPLES) -> None:
        """Prepare the kernels.

        Args:
            samples: paths of a texel.
        """
        self.tracer = RadianceTracer(samples, lanes=1 << 19, depth=BAKE_DEPTH)

    def scene(self, mesh: TriangleMesh, bsdf: WardBSDF, room: Room, seed: int) -> Any:
        """The object in the room; equal seeds give equal scenes.

        Args:
            mesh: the shape.
            bsdf: the material.
            room: the room that the object stands in.
            seed: of the random numbers.
        """
        lights = light_shapes(room)
        shape = mitsuba_mesh(mesh, bsdf)
        albedo = atlas([surface.albedo for surface in room.surfaces])
        matte = mi.load_dict({"type": "diffuse", "reflectance": texture(albedo)})
        walls = _walls(room.surfaces, matte, None)
        reflecting = mi.load_dict({"type": "scene", OBJECT: shape, WALLS: walls, **lights})
        radiance = atlas(self._bake(reflecting, room.surfaces, seed))
        black = mi.load_dict({"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}})
        walls = _walls(room.surfaces, black, glow(radiance, weight=0.0))
        return mi.load_dict({"type": "scene", OBJECT: shape, WALLS: walls, **lights})

    def _bake(self, scene: Any, surfaces: list[Surface], seed: int) -> list[NDArray[np.float32]]:
        """Radiance (T, T, 3) of every surface: coarse light on it, times its paint."""
        grids = [_texels(surface) for surface in surfaces]
        normals = [
            np.broadcast_to(surface.panel.normal, grid.shape)
            for surface, grid in zip(surfaces, grids, strict=True)
        ]
        points = np.concatenate([grid.reshape(-1, 3) for grid in grids])
        facing = np.concatenate([normal.reshape(-1, 3) for normal in normals])
        traced = self.tracer.trace(
            scene,
            (points + ABOVE * facing).astype(np.float32),
            -facing.astype(np.float32),
            seed,
        )
        sizes = [grid.shape[0] * grid.shape[1] for grid in grids]
        parts = np.split(traced, np.cumsum(sizes)[:-1])
        tiles = []
        for surface, grid, part in zip(surfaces, grids, parts, strict=True):
            paint = _at_texels(surface.albedo, grid.shape[:2])
            light = (part.reshape(grid.shape) / paint).astype(np.float32)
            smooth = cv2.GaussianBlur(light, (0, 0), SMOOTHING, borderType=cv2.BORDER_REPLICATE)
            tiles.append(spread(np.asarray(smooth, np.float32)) * surface.albedo)
        return tiles


def _texels(surface: Surface) -> NDArray[np.float64]:
    edges = surface.panel.up, surface.panel.across
    rows, columns = (
        int(np.clip(math.ceil(float(np.linalg.norm(edge)) / surface.texel), 3, 40))
        for edge in edges
    )
    return surface.panel.grid(rows, columns)


def _at_texels(albedo: NDArray[np.float32], shape: tuple[int, ...]) -> NDArray[np.float32]:
    """The paint at the middle of each coarse texel, as Mitsuba interpolates it."""
    size = len(albedo)
    v, u = ((np.arange(count) + 0.5) / count * (size - 1) for count in shape)
    top, left = (np.minimum(p.astype(np.int64), size - 2) for p in (v, u))
    down, along = (v - top)[:, None, None], (u - left)[None, :, None]
    upper = albedo[top][:, left] * (1 - along) + albedo[top][:, left + 1] * along
    lower = albedo[top + 1][:, left] * (1 - along) + albedo[top + 1][:, left + 1] * along
    return np.asarray(upper * (1 - down) + lower * down, np.float32)


def _walls(surfaces: list[Surface], bsdf: Any, emitter: Any | None) -> Any:
    return textured_mesh(*panel_mesh([surface.panel for surface in surfaces]), bsdf, emitter)
