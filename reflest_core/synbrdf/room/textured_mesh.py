# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Flat-shaded meshes with texture coordinates. Importing this module loads Mitsuba."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.path_tracing.mitsuba_scene import mi


def textured_mesh(
    vertices: NDArray[np.floating],
    places: NDArray[np.floating],
    faces: NDArray[np.integer],
    bsdf: Any | None = None,
    emitter: Any | None = None,
) -> Any:
    """Make a textured mesh of Mitsuba's.

    Args:
        vertices: (V, 3) metres.
        places: (V, 2) texture coordinates.
        faces: (F, 3) vertex indices.
        bsdf: Mitsuba BSDF; None for black.
        emitter: Mitsuba emitter; None for none.
    """
    properties = mi.Properties()
    if bsdf is not None:
        properties["mesh_bsdf"] = bsdf
    if emitter is not None:
        properties["emitter"] = emitter
    shape = mi.Mesh("mesh", len(vertices), len(faces), has_vertex_texcoords=True, props=properties)
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = mi.Float(vertices.astype(np.float32).reshape(-1))
    parameters["vertex_texcoords"] = mi.Float(places.astype(np.float32).reshape(-1))
    parameters["faces"] = mi.UInt32(faces.astype(np.uint32).reshape(-1))
    parameters.update()
    return shape
