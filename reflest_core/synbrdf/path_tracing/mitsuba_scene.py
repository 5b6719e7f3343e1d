# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A SynBRDF scene as Mitsuba holds it. Importing this module loads Mitsuba."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.path_tracing.mitsuba_runtime import load_mitsuba
from reflest_core.synbrdf.path_tracing.ward_bsdf import WardBSDF
from reflest_core.synbrdf.shapes.mesh import TriangleMesh

mi: Any = load_mitsuba()
import drjit as dr  # noqa: E402  (Mitsuba's loader must choose the LLVM first)

PATH_DEPTH = 4
"""Mitsuba's ``max_depth`` of what the networks see."""
TABLETOP_DEPTH = 6
"""Mitsuba's ``max_depth`` of scenes of several objects, which light one another."""
OBJECT = "object"
"""The object's name among a scene's shapes."""
ENVIRONMENT_TURNS = (("z", 90.0), ("x", 90.0))
"""Axes and degrees, multiplied in this order: Mitsuba's maps have y up and azimuth measured from
-z; those of :mod:`.environments` have z up and u = 1/2 at +x."""


def mitsuba_scene(mesh: TriangleMesh, bsdf: WardBSDF, radiance: NDArray[np.float32]) -> Any:
    """The object under a lat-long map in the convention of :mod:`.environments`.

    Args:
        mesh: the shape.
        bsdf: the material.
        radiance: (H, W, 3) environment, linear.
    """
    to_world = mi.ScalarTransform4f()
    for axis, degrees in ENVIRONMENT_TURNS:
        to_world = to_world.rotate([float(axis == name) for name in "xyz"], degrees)
    environment = {"type": "envmap", "bitmap": mi.Bitmap(radiance), "to_world": to_world}
    shape = mitsuba_mesh(mesh, bsdf)
    return mi.load_dict({"type": "scene", OBJECT: shape, "environment": environment})


def mitsuba_mesh(mesh: TriangleMesh, bsdf: WardBSDF) -> Any:
    """The object alone, in single precision.

    Args:
        mesh: the shape.
        bsdf: the material.
    """
    properties = mi.Properties()
    properties["mesh_bsdf"] = bsdf
    shape = mi.Mesh(
        OBJECT, len(mesh.vertices), len(mesh.faces), has_vertex_normals=True, props=properties
    )
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = mi.Float(mesh.vertices.astype(np.float32).reshape(-1))
    parameters["vertex_normals"] = mi.Float(mesh.normals.astype(np.float32).reshape(-1))
    parameters["faces"] = mi.UInt32(mesh.faces.astype(np.uint32).reshape(-1))
    parameters.update()
    return shape


class RadianceTracer:
    """Path-traces single rays, in wavefronts of one size so that a kernel compiles only once."""

    def __init__(self, samples: int, lanes: int = 1 << 21, depth: int = PATH_DEPTH) -> None:
        """Prepare the integrator.

        Args:
            samples: paths of each ray.
            lanes: paths of a wavefront.
            depth: Mitsuba's ``max_depth``.
        """
        self.samples = samples
        self.rays_at_once = lanes // samples
        self.integrator = mi.load_dict({"type": "path", "max_depth": depth})

    def trace(
        self,
        scene: Any,
        origins: NDArray[np.float32],
        directions: NDArray[np.float32],
        seed: int,
    ) -> NDArray[np.float32]:
        """Trace rays.

        Args:
            scene: the Mitsuba scene.
            origins: (R, 3) metres, world frame.
            directions: (R, 3) unit.
            seed: of the random numbers.

        Returns:
            (R, 3) linear radiance that arrives at the origins from the directions.
        """
        parts = [
            self._trace_some(scene, origins[first:last], directions[first:last], seed + first)
            for first, last in self._chunks(len(origins))
        ]
        return np.concatenate(parts) if parts else np.zeros((0, 3), np.float32)

    def _chunks(self, rays: int) -> list[tuple[int, int]]:
        starts = range(0, rays, self.rays_at_once)
        return [(start, min(start + self.rays_at_once, rays)) for start in starts]

    def _trace_some(
        self,
        scene: Any,
        origins: NDArray[np.float32],
        directions: NDArray[np.float32],
        seed: int,
    ) -> NDArray[np.float32]:
        count = len(origins)
        rows = np.zeros(self.rays_at_once, np.int64)
        rows[:count] = np.arange(count)
        lanes = self.rays_at_once * self.samples
        sampler = mi.load_dict({"type": "multijitter", "sample_count": self.samples})
        sampler.set_samples_per_wavefront(self.samples)
        sampler.seed(seed, lanes)
        ray_index = dr.arange(mi.UInt32, lanes) // self.samples
        ray = mi.RayDifferential3f(
            _gather(origins[rows], ray_index), _gather(directions[rows], ray_index)
        )
        # A number known to the compiler would make another kernel of each count of rays.
        is_ray = ray_index < dr.opaque(mi.UInt32, count)
        radiance, _, _ = self.integrator.sample(scene, sampler, ray, None, is_ray)
        channels = [channel / self.samples for channel in radiance]
        # Unless evaluated here, the sum would be fused into each path-tracing kernel again.
        dr.eval(channels)
        sums = [dr.block_reduce(dr.ReduceOp.Add, channel, self.samples) for channel in channels]
        return np.stack([np.array(channel) for channel in sums], axis=-1)[:count]


def _gather(points: NDArray[np.float32], index: Any) -> Any:
    table = mi.Float(np.ascontiguousarray(points, np.float32).reshape(-1))
    return mi.Point3f(*(dr.gather(mi.Float, table, index * 3 + k) for k in range(3)))


def _rays(origins: NDArray[np.float32], directions: NDArray[np.float32]) -> Any:
    return mi.Ray3f(
        mi.Point3f(np.ascontiguousarray(origins.T)), mi.Vector3f(np.ascontiguousarray(directions.T))
    )


def first_hits(
    scene: Any, origins: NDArray[np.float32], directions: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Distance (R,) in metres to the first surface along each ray; infinity where there is none.

    Args:
        scene: the Mitsuba scene.
        origins: (R, 3) metres, world frame.
        directions: (R, 3) unit.
    """
    hit = scene.ray_intersect_preliminary(_rays(origins, directions))
    distance = np.array(hit.t, dtype=np.float32)
    return np.where(np.array(hit.is_valid()), distance, np.float32(math.inf))


def first_shapes(
    scene: Any, origins: NDArray[np.float32], directions: NDArray[np.float32]
) -> NDArray[np.str_]:
    """Name (R,) of the first shape along each ray; empty where there is none.

    Args:
        scene: the Mitsuba scene.
        origins: (R, 3) metres, world frame.
        directions: (R, 3) unit.
    """
    hit = scene.ray_intersect_preliminary(_rays(origins, directions))
    numbers = np.array(dr.reinterpret_array(mi.UInt32, hit.shape))
    numbers[~np.array(hit.is_valid())] = 0
    shapes = scene.shapes()
    own = np.array([np.array(dr.reinterpret_array(mi.UInt32, mi.ShapePtr(s)))[0] for s in shapes])
    names: NDArray[np.str_] = np.full(own.max() + 1, "", dtype="U16")
    names[own] = [shape.id() for shape in shapes]
    return np.asarray(names[numbers])


def first_faces(
    scene: Any, origins: NDArray[np.float32], directions: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.bool_]]:
    """What each ray first hits.

    Args:
        scene: The Mitsuba scene.
        origins: (R, 3) metres.
        directions: (R, 3) unit.

    Returns:
        Distance (R,) in metres, infinite where nothing is hit; index (R,) of the face, within its
        mesh; and whether the mesh is the object's (R,).
    """
    hit = scene.ray_intersect_preliminary(_rays(origins, directions))
    is_hit = np.array(hit.is_valid())
    distance = np.where(is_hit, np.array(hit.t, dtype=np.float32), np.float32(math.inf))
    faces = np.where(is_hit, np.array(hit.prim_index), 0).astype(np.int64)
    return distance, faces, first_shapes(scene, origins, directions) == OBJECT


def first_normals(
    scene: Any, origins: NDArray[np.float32], directions: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Unit shading normals (R, 3), world frame, where each ray first hits; 0 where it does not.

    Args:
        scene: the Mitsuba scene.
        origins: (R, 3) metres, world frame.
        directions: (R, 3) unit.
    """
    hit = scene.ray_intersect(_rays(origins, directions))
    normal = dr.select(hit.is_valid(), dr.normalize(hit.sh_frame.n), mi.Normal3f(0.0))
    return np.ascontiguousarray(np.array(normal, dtype=np.float32).T)
