# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A material map as a point cloud: binary PLY with every observed voxel."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from reflest_core.estimation.material_map import MaterialMap
from reflest_core.export.errors import check_suffix
from reflest_core.ply_file import write_ply
from reflest_core.whole_file import whole_file

CHANNELS = ("r", "g", "b")
VERTEX = np.dtype(
    [
        *[(name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")],
        *[(f"rho_d_{channel}", "<f4") for channel in CHANNELS],
        ("rho_s", "<f4"),
        ("alpha", "<f4"),
        *[(f"rho_d_{channel}_stddev", "<f4") for channel in CHANNELS],
        ("rho_s_stddev", "<f4"),
        ("alpha_stddev", "<f4"),
        ("views", "<u2"),
        ("material_id", "<u4"),
        ("normal_stddev", "<f4"),
    ]
)
"""Properties of the element ``vertex``: metres in the world frame, unit normals, linear sRGB, and
the standard deviation of the normal about each tangent axis, radians."""
FAR_VERTEX = np.dtype(
    [(name, "<f8" if name in "xyz" else kind) for name, (kind, *_) in (VERTEX.fields or {}).items()]
)
"""The same far from the world's origin, where float32 would lose millimetres."""


def export_materials(materials: MaterialMap, path: Path) -> None:
    """Write every observed voxel of a map with its material, whole or not at all.

    Args:
        materials: of a scan.
        path: ends in ``.ply``.

    Raises:
        ExportError: Another suffix.
        ReflestError: The file cannot be written.
    """
    check_suffix(path, ".ply", "ply")
    comments = ["reflest materials: metres, linear sRGB, Ward's model"]
    if materials.world_frame_id:
        comments.append(f"frame {materials.world_frame_id}")
    with whole_file(path) as file:
        write_ply(file, {"vertex": material_vertices(materials)}, comments)


def material_vertices(materials: MaterialMap) -> np.ndarray:
    """Spread a map over its voxels.

    Args:
        materials: of a scan.

    Returns:
        (N,) records of the type :data:`VERTEX`, or :data:`FAR_VERTEX` where the scan has an origin
        of its own, one for each voxel with an observation; NaN where a value is unknown.
    """
    surface = materials.surface
    counts = surface.observation_counts
    observed = np.flatnonzero(counts > 0)
    vertices = np.zeros(len(observed), FAR_VERTEX if surface.origin.any() else VERTEX)
    positions = surface.world_positions[observed]
    for axis, name in enumerate("xyz"):
        vertices[name] = positions[:, axis]
        vertices[f"n{name}"] = surface.normals[observed, axis]
    for axis, channel in enumerate(CHANNELS):
        vertices[f"rho_d_{channel}"] = materials.rho_d[observed, axis]
        vertices[f"rho_d_{channel}_stddev"] = materials.rho_d_stddev[observed, axis]
    for name in ("rho_s", "alpha", "rho_s_stddev", "alpha_stddev"):
        vertices[name] = materials.of_voxels(name)[observed]
    vertices["views"] = np.minimum(counts[observed], np.iinfo(np.uint16).max)
    vertices["material_id"] = materials.material_ids[observed]
    vertices["normal_stddev"] = materials.normal_stddev[observed]
    return vertices
