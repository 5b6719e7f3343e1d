# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The surface, its colours and its light as the page's script reads them."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.environment.environment_map import from_octahedral
from reflest_core.rendering.environments import studio
from reflest_core.surface.upright import rotation_to_z
from reflest_core.viewer.colour_modes import ColourMode, coloured, modes_of
from reflest_core.viewer.shading import Shading, displayed

FINEST = 65535
"""Of the integers that positions are stored as, over the longest edge of the scan's box."""
LIGHT_ROWS = 64
"""Of the light that highlights are looked up in."""
BRIGHTEST = 16.0
"""Radiance that the light is clipped at, in units of the camera's white."""


def model_data(shading: Shading) -> dict[str, Any]:
    """Gather what the script draws.

    Args:
        shading: of the scan.

    Returns:
        JSON values; arrays are base64 of little-endian bytes. ``positions``: uint16 (N, 3) in
        units of ``step``, z up, around ``middle``. ``normals``: int8 (N, 3). ``faces``: uint32
        (F, 3). ``materials``: uint8 (N,), 1 + the index into ``gloss``, 0 for none. ``diffuse``:
        uint8 (N, 3), diffuse radiance in sRGB. ``modes``: ``name``, ``legend`` and ``colours``,
        uint8 (N, 3), of each. ``light``: uint8 (H, 2 H, 4), square roots of radiance over
        ``brightest`` with a common factor. ``gloss``: id, ``rho_s`` and ``alpha`` of materials.
    """
    scan = shading.scan
    rotation = rotation_to_z(scan.up)
    vertices = scan.vertices @ rotation.T
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    step = float((high - low).max()) / FINEST
    positions = np.rint((vertices - low) / step).astype("<u2")
    index = {one.id: number for number, one in enumerate(scan.found.materials[:255], 1)}
    materials = np.array([index.get(int(one), 0) for one in scan.material_ids], np.uint8)
    light = shading.light(shading.lights[0])
    modes = []
    for mode in modes_of(scan):
        if mode is not ColourMode.RENDERED:
            found = coloured(scan, mode)
            modes.append(
                {"name": mode.value, "legend": found.legend, "colours": packed(found.colours)}
            )
    return {
        "step": step,
        "middle": ((high - low) / step / 2.0).tolist(),
        "positions": packed(positions),
        "normals": packed(np.rint(127.0 * scan.normals @ rotation.T).astype(np.int8)),
        "faces": packed(scan.faces.astype("<u4")),
        "materials": packed(materials),
        "diffuse": packed(displayed(shading.diffuse(light))),
        "modes": modes,
        "light": packed(_rgbm(_radiance(scan.light))),
        "lightRows": LIGHT_ROWS,
        "brightest": BRIGHTEST,
        "gloss": [
            [one.id, one.estimate.rho_s, one.estimate.alpha] for one in scan.found.materials[:255]
        ],
    }


def packed(array: NDArray[Any]) -> str:
    """The bytes of an array as base64.

    Args:
        array: of a little-endian or one-byte type.
    """
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()


def _radiance(light: NDArray[np.float32] | None) -> NDArray[np.float32]:
    return studio(LIGHT_ROWS) if light is None else from_octahedral(light, LIGHT_ROWS).radiance


def _rgbm(radiance: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(H, W, 4): square roots of the radiance's share of a common factor, and that factor."""
    root = np.sqrt(np.clip(radiance, 0.0, BRIGHTEST) / BRIGHTEST)
    factor = np.ceil(255.0 * np.maximum(root.max(axis=-1, keepdims=True), 1.0 / 255.0)) / 255.0
    return np.rint(255.0 * np.concatenate([root / factor, factor], axis=-1)).astype(np.uint8)
