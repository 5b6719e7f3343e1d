# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The scanned surface as a triangle mesh: marching cubes over the TSDF, cleaned and decimated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from reflest_core.export.errors import ExportError
from reflest_core.export.libraries import library, open3d
from reflest_core.fusion.scan import Scan
from reflest_core.surface.voxel_key import BLOCK_EDGE, key_coordinates

OBSERVED_WITHIN = 1.75
"""A vertex without an observed voxel within so many voxels is not of the scanned surface."""
SMALLEST_PIECE = 40.0
"""A loose piece of less area than so many squared voxels is noise."""
POISSON_VOXELS = 1.5
"""Cells of the Poisson reconstruction are about so many voxels wide."""
FARTHEST_CLOSED = 0.3
"""Share of the scan's size by which a closed surface may pass it."""


@dataclass(frozen=True)
class TriangleMesh:
    """Vertices and triangles in the world frame.

    Attributes:
        vertices: (N, 3) float32, metres.
        faces: (F, 3) int32, counter-clockwise from outside.
    """

    vertices: NDArray[np.float32]
    faces: NDArray[np.int32]

    @property
    def face_normals(self) -> NDArray[np.float64]:
        """(F, 3) outward normals whose length is twice the face's area."""
        corners = self.vertices[self.faces].astype(np.float64)
        return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])

    @property
    def vertex_normals(self) -> NDArray[np.float32]:
        """(N, 3) unit mean of the faces' normals, weighted by area."""
        normals = np.zeros((len(self.vertices), 3))
        of_faces = self.face_normals
        for corner in range(3):
            for axis in range(3):
                normals[:, axis] += np.bincount(
                    self.faces[:, corner], of_faces[:, axis], len(self.vertices)
                )
        lengths = np.linalg.norm(normals, axis=1, keepdims=True)
        return np.where(lengths > 1e-12, normals / np.maximum(lengths, 1e-12), [0, 0, 1]).astype(
            np.float32
        )

    def kept(self, is_kept: NDArray[np.bool_]) -> TriangleMesh:
        """The faces that are kept, and their vertices.

        Args:
            is_kept: (F,) bool.
        """
        used, flat = np.unique(self.faces[is_kept], return_inverse=True)
        return TriangleMesh(self.vertices[used], flat.reshape(-1, 3).astype(np.int32))


def scanned_mesh(scan: Scan, faces: int, is_watertight: bool = False) -> TriangleMesh:
    """Extract and decimate the surface of a scan.

    Args:
        scan: What was fused.
        faces: The mesh is decimated to about so many.
        is_watertight: As in :func:`surface_mesh`.

    Raises:
        ExportError: Nothing was scanned, or a package of the extra ``asset`` is missing.
    """
    return decimated(surface_mesh(scan, is_watertight), faces)


def surface_mesh(scan: Scan, is_watertight: bool = False) -> TriangleMesh:
    """Extract the surface of a scan, in the resolution of its voxels.

    Args:
        scan: What was fused.
        is_watertight: Close the surface (screened Poisson reconstruction, Kazhdan and Hoppe 2013)
            where nothing was scanned.

    Raises:
        ExportError: Nothing was scanned, a package of the extra ``asset`` is missing, or what
            should be closed is open.
    """
    observed = scan.store.rows.positions[: scan.store.count]
    if not len(observed):
        raise ExportError("nothing was scanned: there is no surface to export")
    voxel_size = scan.fusion.voxel_size
    if is_watertight:
        mesh = _poisson(observed, scan.store.rows.normals[: scan.store.count], voxel_size)
        check_closed(mesh, observed)
    else:
        mesh = _without_loose_pieces(
            _near(_marching_cubes(scan), observed, OBSERVED_WITHIN * voxel_size), voxel_size
        )
    if not len(mesh.faces):
        raise ExportError("the scan holds no connected surface: scan more of the object")
    return mesh


def mesh_of_voxels(
    positions: NDArray[np.float32], normals: NDArray[np.float32], voxel_size: float, faces: int
) -> TriangleMesh:
    """Reconstruct the surface where its voxels alone are at hand, and no volume.

    Args:
        positions: (V, 3) metres.
        normals: (V, 3) unit, outward.
        voxel_size: Edge of a voxel, metres.
        faces: The mesh is decimated to about so many.

    Raises:
        ExportError: The voxels make no surface, or a package of the extra ``asset`` is missing.
    """
    closed = _poisson(positions, normals, voxel_size)
    mesh = _without_loose_pieces(_near(closed, positions, OBSERVED_WITHIN * voxel_size), voxel_size)
    if not len(mesh.faces):
        raise ExportError("the voxels make no connected surface: scan more of the object")
    return decimated(mesh, faces)


def _marching_cubes(scan: Scan) -> TriangleMesh:
    o3d = open3d()
    volume, blocks = scan.volume, scan.volume.blocks
    core, count = o3d.core, volume.count
    grid = o3d.t.geometry.VoxelBlockGrid(
        ("tsdf", "weight"),
        (core.float32, core.float32),
        ((1,), (1,)),
        volume.voxel_size,
        BLOCK_EDGE,
        max(count, 1),
        core.Device("CPU:0"),
    )
    rows, _ = grid.hashmap().activate(
        core.Tensor(key_coordinates(blocks.keys[:count]).astype(np.int32))
    )
    rows = rows.numpy()
    # Open3D's blocks hold x in the last axis, ours in the first.
    for name, values in (("tsdf", blocks.tsdf), ("weight", blocks.weight)):
        grid.attribute(name).numpy()[rows, ..., 0] = values[:count].transpose(0, 3, 2, 1)
    found = grid.extract_triangle_mesh(weight_threshold=1.0)
    return _ordered(found.vertex.positions.numpy(), found.triangle.indices.numpy())


def _ordered(vertices: NDArray[np.floating], faces: NDArray[np.integer]) -> TriangleMesh:
    """The mesh in an order of its own: Open3D's depends on threads and hashes."""
    order = np.lexsort(vertices.T)
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order), dtype=np.int32)
    ranked = rank[faces]
    first = ranked.argmin(axis=1)[:, None]
    turned = np.take_along_axis(ranked, (first + np.arange(3)) % 3, axis=1)
    return TriangleMesh(vertices[order].astype(np.float32), turned[np.lexsort(turned.T)])


def _near(mesh: TriangleMesh, observed: NDArray[np.float32], reach: float) -> TriangleMesh:
    distances, _ = cKDTree(observed).query(mesh.vertices, distance_upper_bound=reach)
    return mesh.kept(np.isfinite(distances)[mesh.faces].all(axis=1))


def _without_loose_pieces(mesh: TriangleMesh, voxel_size: float) -> TriangleMesh:
    faces = mesh.faces
    corners = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]]])
    size = (len(mesh.vertices),) * 2
    graph = coo_matrix((np.ones(len(corners), np.int8), (corners[:, 0], corners[:, 1])), size)
    _, piece_of_vertex = connected_components(graph, directed=False)
    piece = piece_of_vertex[faces[:, 0]]
    areas = np.bincount(piece, 0.5 * np.linalg.norm(mesh.face_normals, axis=1))
    is_large = areas >= min(SMALLEST_PIECE * voxel_size**2, areas.max(initial=0.0))
    return mesh.kept(is_large[piece])


def _poisson(
    positions: NDArray[np.float32], normals: NDArray[np.float32], voxel_size: float
) -> TriangleMesh:
    o3d = open3d()
    cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(positions.astype(np.float64)))
    cloud.normals = o3d.utility.Vector3dVector(normals.astype(np.float64))
    try:
        mesh, _ = o3d.geometry.TriangleMesh.create_from_point_cloud_poisson(
            cloud, depth=0, width=POISSON_VOXELS * voxel_size, n_threads=1
        )
    except RuntimeError as error:  # of Open3D, where too few points span too little
        raise ExportError(
            f"{len(positions)} voxels make no surface: scan more of the object"
        ) from error
    return TriangleMesh(
        np.asarray(mesh.vertices).astype(np.float32), np.asarray(mesh.triangles).astype(np.int32)
    )


def check_closed(mesh: TriangleMesh, observed: NDArray[np.float32]) -> None:
    """Refuse a surface that was not closed, or closed by a bubble far beyond what was scanned.

    Args:
        mesh: what should be closed.
        observed: (V, 3) voxels, metres.

    Raises:
        ExportError: It is open, or much larger than the scan.
    """
    edges = np.sort(np.concatenate([mesh.faces[:, [n, (n + 1) % 3]] for n in range(3)]), axis=1)
    _, uses = np.unique(edges, axis=0, return_counts=True)
    size = float(np.ptp(observed, axis=0).max())
    beyond = float(np.ptp(mesh.vertices, axis=0).max()) - size
    if (uses == 1).any() or beyond > FARTHEST_CLOSED * size:
        raise ExportError(
            "the scan is an open surface, such as a table, and cannot be closed: scan one object "
            "from all sides with a region of interest, or export without --watertight"
        )


def decimated(mesh: TriangleMesh, faces: int) -> TriangleMesh:
    """Simplify a mesh by quadric error metrics (Garland and Heckbert 1997).

    Args:
        mesh: Any mesh.
        faces: About so many are left.

    Raises:
        ExportError: A package of the extra ``asset`` is missing.
    """
    if len(mesh.faces) > faces:
        simplify: Any = library("fast_simplification").simplify
        vertices, triangles = simplify(mesh.vertices, mesh.faces, target_count=faces)
        mesh = TriangleMesh(vertices.astype(np.float32), triangles.astype(np.int32))
    return mesh.kept(np.linalg.norm(mesh.face_normals, axis=1) > 0.0)
