# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The scanned surface as a triangle mesh: screened Poisson reconstruction, trimmed and decimated.

Poisson reconstruction (Kazhdan and Hoppe 2013) makes one closed surface through all voxels. Where
something was scanned it averages the noise of the depth; where nothing was, it continues what lies
around. A small gap, as below an object's overhang or where it stands on a table, is therefore
closed smoothly. A base below what was scanned from above (:mod:`.flat_base`) makes it a solid,
which joins objects to what they stand on. An open mesh has base and large gaps cut out again.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reflest_core.export.errors import ExportError
from reflest_core.export.flat_base import base_below
from reflest_core.export.libraries import open3d
from reflest_core.export.triangle_mesh import TriangleMesh, decimated
from reflest_core.fusion.scan import Scan

OBSERVED_WITHIN = 1.75
"""A vertex with an observed voxel within so many voxels is of the scanned surface."""
FILLED_WITHIN = 10.0
"""A gap is filled if all of the filling has observed voxels within so many voxels."""
SMALLEST_PIECE = 40.0
"""A loose piece of less area than so many squared voxels is noise."""
POISSON_VOXELS = 1.0
"""Cells of the Poisson reconstruction are about so many voxels wide."""
FARTHEST_CLOSED = 0.3
"""Share of the scan's size by which a closed surface may pass it."""
Z_UP = (0.0, 0.0, 1.0)


def scanned_mesh(
    scan: Scan,
    faces: int,
    is_watertight: bool = False,
    up: tuple[float, float, float] = Z_UP,
) -> TriangleMesh:
    """Reconstruct and decimate the surface of a scan.

    Args:
        scan: What was fused.
        faces: As in :func:`mesh_of_voxels`.
        is_watertight: As in :func:`mesh_of_voxels`.
        up: As in :func:`mesh_of_voxels`.

    Raises:
        ExportError: As :func:`mesh_of_voxels`.
    """
    rows, count = scan.store.rows, scan.store.count
    return mesh_of_voxels(
        rows.positions[:count],
        rows.normals[:count],
        scan.fusion.voxel_size,
        faces,
        is_watertight,
        up,
    )


def mesh_of_voxels(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    voxel_size: float,
    faces: int,
    is_watertight: bool = False,
    up: tuple[float, float, float] = Z_UP,
) -> TriangleMesh:
    """Reconstruct and decimate the surface that voxels lie on.

    Args:
        positions: (V, 3) metres.
        normals: (V, 3) unit, outward.
        voxel_size: Edge of a voxel, metres.
        faces: The mesh is decimated to about so many.
        is_watertight: Close the surface: what is open below gets a flat base.
        up: Up in the voxels' frame, for the base.

    Raises:
        ExportError: The voxels make no surface, what should be closed cannot be, or a package of
            the extra ``asset`` is missing.
    """
    if not len(positions):
        raise ExportError("nothing was scanned: there is no surface to export")
    base = base_below(positions, normals, voxel_size, up)
    mesh = _poisson(
        np.concatenate([positions, base.positions]),
        np.concatenate([normals, base.normals]),
        voxel_size,
        len(positions),
    )
    if is_watertight:
        mesh = base.levelled(_scanned_pieces(mesh, positions, voxel_size))
        check_closed(mesh, positions)
        return decimated(mesh, faces)
    mesh = _trimmed(mesh, positions, base.positions, voxel_size)
    mesh = _without_loose_pieces(mesh, voxel_size)
    if not len(mesh.faces):
        raise ExportError("the scan holds no connected surface: scan more of the object")
    return decimated(mesh, faces)


def check_closed(mesh: TriangleMesh, observed: NDArray[np.float32]) -> None:
    """Refuse a surface that was not closed, or closed by a bubble far beyond what was scanned.

    Args:
        mesh: What should be closed.
        observed: (V, 3) voxels, metres.

    Raises:
        ExportError: It is open, or much larger than the scan.
    """
    size = float(np.ptp(observed, axis=0).max())
    beyond = np.maximum(mesh.vertices.max(axis=0) - observed.max(axis=0), 0.0)
    beyond = np.maximum(beyond, observed.min(axis=0) - mesh.vertices.min(axis=0))
    if not mesh.is_closed or float(beyond.max()) > FARTHEST_CLOSED * size:
        raise ExportError(
            "the scan is an open surface, such as a wall seen from one side, and cannot be closed: "
            "scan one object or a table with a region of interest, or export without --watertight"
        )


def _poisson(
    positions: NDArray[np.float32], normals: NDArray[np.float32], voxel_size: float, scanned: int
) -> TriangleMesh:
    """The closed surface through voxels."""
    o3d = open3d()
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(positions.astype(np.float64)))
    cloud.normals = o3d.utility.Vector3dVector(normals.astype(np.float64))
    try:
        mesh, _ = o3d.geometry.TriangleMesh.create_from_point_cloud_poisson(
            cloud, depth=0, width=POISSON_VOXELS * voxel_size, n_threads=1
        )
    except RuntimeError as error:  # of Open3D, where too few points span too little
        raise ExportError(f"{scanned} voxels make no surface: scan more of the object") from error
    if not len(mesh.triangles):
        raise ExportError(f"{scanned} voxels make no surface: scan more of the object")
    return TriangleMesh(
        np.asarray(mesh.vertices).astype(np.float32), np.asarray(mesh.triangles).astype(np.int32)
    )


def _trimmed(
    mesh: TriangleMesh,
    observed: NDArray[np.float32],
    base: NDArray[np.float32],
    voxel_size: float,
) -> TriangleMesh:
    """The faces near observed voxels, and those that fill gaps between them."""
    distances, nearest = cKDTree(np.concatenate([observed, base])).query(mesh.vertices)
    distances[nearest >= len(observed)] = np.inf
    is_near = (distances <= OBSERVED_WITHIN * voxel_size)[mesh.faces].all(axis=1)
    beyond = TriangleMesh(mesh.vertices, mesh.faces[~is_near])
    gap = beyond.pieces()
    farthest = np.zeros(int(gap.max(initial=-1)) + 1)
    np.maximum.at(farthest, gap, distances[beyond.faces].max(axis=1))
    is_kept = is_near.copy()
    is_kept[~is_near] = (farthest <= FILLED_WITHIN * voxel_size)[gap]
    return mesh.kept(is_kept)


def _without_loose_pieces(mesh: TriangleMesh, voxel_size: float) -> TriangleMesh:
    piece = mesh.pieces()
    areas = np.bincount(piece, mesh.face_areas)
    is_large = areas >= min(SMALLEST_PIECE * voxel_size**2, areas.max(initial=0.0))
    return mesh.kept(is_large[piece])


def _scanned_pieces(
    mesh: TriangleMesh, observed: NDArray[np.float32], voxel_size: float
) -> TriangleMesh:
    """The pieces that observed voxels lie on, without noise; what was closed elsewhere is left out.

    Each object of a scan without a table is a piece of its own.
    """
    piece = mesh.pieces()
    places = mesh.vertices[mesh.faces].mean(axis=1)
    is_near = cKDTree(observed).query(places)[0] <= OBSERVED_WITHIN * voxel_size
    scanned = np.bincount(piece, mesh.face_areas * is_near)
    is_kept = scanned >= min(SMALLEST_PIECE * voxel_size**2, scanned.max(initial=0.0))
    return mesh.kept(is_kept[piece])
