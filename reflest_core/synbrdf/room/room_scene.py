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

from reflest_core.brdf.lab import luminance
from reflest_core.synbrdf.mitsuba_scene import OBJECT, RadianceTracer, mi, mitsuba_mesh
from reflest_core.synbrdf.room.atlas import atlas, panel_mesh, spread
from reflest_core.synbrdf.room.geometry import Globe, PanelLight, Room, Surface
from reflest_core.synbrdf.shapes.mesh import TriangleMesh
from reflest_core.synbrdf.ward_bsdf import WardBSDF

BAKE_DEPTH = 8
"""Mitsuba's ``max_depth`` of the light on the walls."""
BAKE_SAMPLES = 64
SMOOTHING = 0.7
"""Texels, Gaussian: the noise of the light on a wall would else look like another paint."""
ABOVE = 1e-3
"""Metres over a wall from which it is looked at."""
LEAST_SHARE = 0.1
"""Of an even share of shadow rays, for lamps that hardly reach the object."""
WALLS, LAMP, GLOBE, WINDOW = "walls", "lamp", "globe", "window"


class RoomBuilder:
    """Makes scenes of rooms one after another with one set of kernels."""

    def __init__(self, samples: int = BAKE_SAMPLES) -> None:
        self.tracer = RadianceTracer(samples, lanes=1 << 19, depth=BAKE_DEPTH)

    def scene(self, mesh: TriangleMesh, bsdf: WardBSDF, room: Room, seed: int) -> Any:
        """The object in the room; equal seeds give equal scenes."""
        lights = _lights(room)
        shape = mitsuba_mesh(mesh, bsdf)
        albedo = atlas([surface.albedo for surface in room.surfaces])
        matte = {"type": "diffuse", "reflectance": _texture(albedo)}
        walls = _walls(room.surfaces, mi.load_dict(matte), None)
        reflecting = mi.load_dict({"type": "scene", OBJECT: shape, WALLS: walls, **lights})
        radiance = atlas(self._bake(reflecting, room.surfaces, seed))
        black = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.0}}
        glow = {"type": "area", "radiance": _texture(radiance), "sampling_weight": 0.0}
        walls = _walls(room.surfaces, mi.load_dict(black), mi.load_dict(glow))
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
    vertices, places, faces = panel_mesh([surface.panel for surface in surfaces])
    properties = mi.Properties()
    properties["mesh_bsdf"] = bsdf
    if emitter is not None:
        properties["emitter"] = emitter
    shape = mi.Mesh(WALLS, len(vertices), len(faces), has_vertex_texcoords=True, props=properties)
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = mi.Float(vertices.astype(np.float32).reshape(-1))
    parameters["vertex_texcoords"] = mi.Float(places.reshape(-1))
    parameters["faces"] = mi.UInt32(faces.reshape(-1))
    parameters.update()
    return shape


def _lights(room: Room) -> dict[str, Any]:
    """Shapes that shine, aimed at by shadow rays as their light reaches the object."""
    panels = [(f"{LAMP}-{k}", lamp) for k, lamp in enumerate(room.lamps)]
    panels += [(f"{WINDOW}-{k}", pane) for k, pane in enumerate(room.windows)]
    globes = [(f"{GLOBE}-{k}", globe) for k, globe in enumerate(room.globes)]
    reach = {name: _panel_reach(light) for name, light in panels}
    reach |= {name: _globe_reach(globe) for name, globe in globes}
    least = LEAST_SHARE * sum(reach.values()) / max(len(reach), 1)
    weights = {name: max(value, least) for name, value in reach.items()}
    shapes: dict[str, Any] = {}
    for name, light in panels:
        panel = light.panel
        to_world = np.eye(4)
        to_world[:3, 0], to_world[:3, 1] = 0.5 * panel.across, 0.5 * panel.up
        to_world[:3, 2], to_world[:3, 3] = panel.normal, panel.middle
        shapes[name] = {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f(to_world),
            "emitter": _area(light.radiance, weights[name]),
        }
    for name, globe in globes:
        shapes[name] = {
            "type": "sphere",
            "center": globe.centre.tolist(),
            "radius": globe.radius,
            "emitter": _area(globe.radiance.reshape(1, 1, 3), weights[name]),
        }
    return shapes


def _area(radiance: NDArray[Any], weight: float) -> dict[str, Any]:
    if radiance.shape[:2] == (1, 1):
        value: dict[str, Any] = {"type": "rgb", "value": radiance.reshape(3).tolist()}
    else:
        value = _texture(np.asarray(radiance, np.float32))
    return {"type": "area", "radiance": value, "sampling_weight": weight}


def _panel_reach(light: PanelLight) -> float:
    middle = light.panel.middle
    distance = float(np.linalg.norm(middle))
    cosine = abs(float(light.panel.normal @ middle)) / distance
    mean = float(luminance(light.radiance.reshape(-1, 3).astype(np.float64)).mean())
    return mean * light.panel.area * cosine / distance**2


def _globe_reach(globe: Globe) -> float:
    mean = float(luminance(globe.radiance[None])[0])
    return mean * math.pi * globe.radius**2 / float(globe.centre @ globe.centre)


def _texture(image: NDArray[np.float32]) -> dict[str, Any]:
    return {"type": "bitmap", "bitmap": mi.Bitmap(image), "raw": True, "wrap_mode": "clamp"}
