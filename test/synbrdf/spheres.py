# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Triangulated spheres without poles."""

import numpy as np

from reflest_core.synbrdf.shapes.mesh import TriangleMesh

GOLDEN = (1 + 5**0.5) / 2


def icosphere(subdivisions=4, radius=1.0, centre=(0.0, 0.0, 0.0)):
    """A subdivided icosahedron with the sphere's own normals."""
    corners = [(0, a, b * GOLDEN) for a in (-1, 1) for b in (-1, 1)]
    points = np.array([np.roll(corner, turn) for turn in range(3) for corner in corners], float)
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    apart = np.linalg.norm(points[:, None] - points[None], axis=-1)
    edge = apart[apart > 0].min() * 1.01
    faces = [
        (a, b, c)
        for a in range(12)
        for b in range(a + 1, 12)
        for c in range(b + 1, 12)
        if max(apart[a, b], apart[b, c], apart[a, c]) < edge
    ]
    triangles = points[np.array(faces)]
    inwards = np.linalg.det(triangles) < 0
    triangles[inwards] = triangles[inwards][:, ::-1]
    for _ in range(subdivisions):
        a, b, c = (triangles[:, k] for k in range(3))
        ab, bc, ca = (_on_sphere(p + q) for p, q in ((a, b), (b, c), (c, a)))
        corners = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = np.concatenate([np.stack(corner, axis=1) for corner in corners])
    normals, index = np.unique(triangles.reshape(-1, 3).round(12), axis=0, return_inverse=True)
    faces = index.reshape(-1, 3).astype(np.int64)
    return TriangleMesh(radius * normals + np.array(centre), _on_sphere(normals), faces)


def joined(first, second):
    """Both meshes as one."""
    return TriangleMesh(
        np.concatenate([first.vertices, second.vertices]),
        np.concatenate([first.normals, second.normals]),
        np.concatenate([first.faces, second.faces + len(first.vertices)]),
    )


def write_obj(path, mesh):
    lines = [f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in mesh.vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in mesh.faces + 1]
    path.write_text("\n".join(lines) + "\n")


def _on_sphere(points):
    return points / np.linalg.norm(points, axis=-1, keepdims=True)
