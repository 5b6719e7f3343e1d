# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Meshes whose vertices have the colours that the page shows: glTF without any light.

viser draws everything through three.js' ACES tone curve (``ACESFilmicToneMapping``, after Stephen
Hill's fit of the Academy's reference transforms). The colours in the file are the curve's inverse
of the wanted ones, so that an sRGB value of the file is the sRGB value on the screen.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.export.libraries import library

TO_CURVE = np.array(
    [[0.59719, 0.35458, 0.04823], [0.07600, 0.90834, 0.01566], [0.02840, 0.13383, 0.83777]]
)
FROM_CURVE = np.array(
    [[1.60475, -0.53108, -0.07367], [-0.10208, 1.10813, -0.00605], [-0.00327, -0.07276, 1.07602]]
)
"""Linear sRGB to the space of the curve and back."""
NUMERATOR = (0.0245786, -0.000090537)
DENOMINATOR = (0.983729, 0.4329510, 0.238081)
"""The curve is ``(v (v + a) + b) / (v (c v + d) + e)``."""
EXPOSURE = 1.0 / 0.6
HIGHEST = 1.0
"""Of the curve's outputs that are inverted; its limit is 1.0165."""


def before_tone_curve(colours: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Invert the page's tone curve.

    Args:
        colours: (N, 3) sRGB as they are to appear.

    Returns:
        (N, 3) linear colours for the file; below 0 for those that the curve would make pale.
    """
    shown = srgb.LINEAR[colours].astype(np.float64)
    y = np.clip(shown @ np.linalg.inv(FROM_CURVE).T, 0.0, HIGHEST)
    (a, b), (c, d, e) = NUMERATOR, DENOMINATOR
    # (c y - 1) v^2 + (d y - a) v + (e y - b) = 0; its positive root.
    quadratic, linear, constant = c * y - 1.0, d * y - a, e * y - b
    v = (-linear - np.sqrt(linear**2 - 4.0 * quadratic * constant)) / (2.0 * quadratic)
    return np.asarray(v @ np.linalg.inv(TO_CURVE).T / EXPOSURE, np.float32)


def unlit_glb(
    vertices: NDArray[np.float32], faces: NDArray[np.int32], colours: NDArray[np.uint8]
) -> bytes:
    """A binary glTF file that shows the colours as they are, from both sides.

    Args:
        vertices: (N, 3) metres.
        faces: (F, 3) indices of vertices, F at least 1.
        colours: (N, 3) sRGB.

    Raises:
        ViewerError: The extra ``viewer`` is not installed.
    """
    trimesh = library("trimesh", "viewer")
    mesh = trimesh.Trimesh(
        vertices,
        faces,
        vertex_attributes={"_COLOUR": before_tone_curve(colours)},
        process=False,
    )
    exchange = library("trimesh.exchange.gltf", "viewer")
    content: bytes = exchange.export_glb(
        trimesh.Scene([mesh]), include_normals=False, tree_postprocessor=_unlit
    )
    return content


def _unlit(tree: dict[str, Any]) -> None:
    for mesh in tree["meshes"]:
        for primitive in mesh["primitives"]:
            attributes = primitive["attributes"]
            attributes["COLOR_0"] = attributes.pop("_COLOUR")
            primitive["material"] = 0
    tree["materials"] = [{"doubleSided": True, "extensions": {"KHR_materials_unlit": {}}}]
    tree["extensionsUsed"] = ["KHR_materials_unlit"]
