# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The voxels of an observation scene: points of the true surface, or what fusion makes of depth.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.capture.refusal import FrameRefused
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.synbrdf.path_tracing.mitsuba_scene import first_faces, first_hits, first_normals
from reflest_core.synbrdf.path_tracing.sight import (
    camera_rays,
    in_image,
    unit,
    visible_pairs,
)
from reflest_core.synbrdf.realism.depth_sensor import DepthSensor
from reflest_core.synbrdf.room.depth_view import room_sight
from reflest_core.synbrdf.scenes.scene import Scene
from reflest_core.synbrdf.scenes.surface_points import draw_surface_points
from reflest_core.synbrdf.scenes.thumbnails import THUMBNAIL
from reflest_core.synbrdf.scenes.views import depth_camera

DRAWN_TO_KEPT = 4
"""Points drawn on a tabletop for each that is kept: many are hidden or out of view."""
NEAR_TRUTH = 0.01
"""Metres from a fused voxel to the true surface along its normal; others belong to nothing."""
WIDTH, HEIGHT = 640, 480
"""Of the depth images that are fused."""
STAMP_STEP_NS = 10**8


@dataclass(frozen=True)
class SceneVoxels:
    """V voxels and the O rays by which views see them, ordered by voxel.

    Attributes:
        positions: (V, 3) float32, metres.
        normals: (V, 3) float32, unit.
        faces: (V,) face of the scene's mesh that each lies on.
        voxel_of: (O,) index of each ray's voxel.
        view_of: (O,) index of its view.
        directions: (O, 3) float32, unit, from the true camera.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    faces: NDArray[np.int64]
    voxel_of: NDArray[np.int64]
    view_of: NDArray[np.int64]
    directions: NDArray[np.float32]


def exact_voxels(rendered: Any, scene: Scene, points: int, rng: np.random.Generator) -> SceneVoxels:
    """Draw points on the true surface.

    Args:
        rendered: The scene as Mitsuba holds it.
        scene: One object that all views show whole, or a tabletop.
        points: Voxels; of a tabletop those that some view sees.
        rng: Source of the draw.
    """
    centres = scene.poses[:, :3, 3].astype(np.float32)
    is_uniform = scene.painted.is_uniform
    drawn = points if is_uniform else DRAWN_TO_KEPT * points
    weights = None if is_uniform else scene.painted.densities()
    positions, normals, faces = draw_surface_points(scene.mesh, drawn, rng, weights)
    voxel_of, view_of = visible_pairs(rendered, positions, normals, centres)
    if not is_uniform:
        within = np.stack([in_image(positions, THUMBNAIL, pose) for pose in scene.poses], axis=1)
        seen = within[voxel_of, view_of]
        voxel_of, view_of = voxel_of[seen], view_of[seen]
        kept = np.unique(voxel_of)[:points]
        chosen = np.isin(voxel_of, kept)
        voxel_of, view_of = np.searchsorted(kept, voxel_of[chosen]), view_of[chosen]
        positions, normals, faces = positions[kept], normals[kept], faces[kept]
    directions = unit(positions[voxel_of] - centres[view_of])
    return SceneVoxels(positions, normals, faces, voxel_of, view_of, directions)


def fused_voxels(
    rendered: Any,
    scene: Scene,
    points: int,
    sensor: DepthSensor,
    tracked: NDArray[np.float64],
    rng: np.random.Generator,
) -> SceneVoxels:
    """Fuse depth images of all views as the estimator does.

    Positions and normals then have errors that are correlated in space, rims and holes, and a
    voxel has the observations that the estimator would keep.

    Args:
        rendered: The scene as Mitsuba holds it.
        scene: What is scanned.
        points: Most voxels; more are thinned at random.
        sensor: Noise and holes of the depth images.
        tracked: ``T_world_camera`` (W, 4, 4) as a tracker reports the scene's poses.
        rng: Source of noise and thinning.
    """
    camera = depth_camera(WIDTH, HEIGHT)
    scan = Scan(FusionSettings(on_jump="keep"), RegionSettings())
    rgb = np.full((HEIGHT, WIDTH, 3), 128, np.uint8)
    for number, (pose, given) in enumerate(zip(scene.poses, tracked, strict=True)):
        depth = _depth_image(rendered, scene, pose, sensor, rng)
        try:
            scan.fuse(Frame((number + 1) * STAMP_STEP_NS, rgb, depth, given, camera))
        except FrameRefused:
            # A view that sees too little of the object: a real scan would go on, too.
            continue
    surface = scan.snapshot(scan.voxel_count)
    faces, is_true = _true_faces(rendered, surface.positions, surface.normals)
    kept = np.flatnonzero(is_true & (surface.observation_counts > 0))
    if len(kept) > points:
        share = None
        if not scene.painted.is_uniform:
            weights = scene.painted.densities()[faces[kept]]
            share = weights / weights.sum()
        kept = np.sort(rng.choice(kept, points, replace=False, p=share))
    counts = surface.observation_counts[kept]
    voxel_of = np.repeat(np.arange(len(kept)), counts)
    rows = np.arange(len(voxel_of)) - np.repeat(np.cumsum(counts) - counts, counts)
    frame_of = _frames_of(surface.view_centres, tracked)
    view_of = frame_of[surface.view_indices[np.repeat(surface.offsets[kept], counts) + rows]]
    positions = surface.positions[kept]
    # The pixel that the tracked pose takes for the voxel shows what the true pose sees there.
    apart = positions[voxel_of] - tracked[view_of, :3, 3]
    local = np.einsum("oji,oj->oi", tracked[view_of, :3, :3], apart)
    directions = np.einsum("oij,oj->oi", scene.poses[view_of, :3, :3], local)
    return SceneVoxels(
        positions,
        surface.normals[kept],
        faces[kept],
        voxel_of,
        view_of,
        unit(directions.astype(np.float32)),
    )


def _depth_image(
    rendered: Any,
    scene: Scene,
    pose: NDArray[np.float64],
    sensor: DepthSensor,
    rng: np.random.Generator,
) -> NDArray[np.float32]:
    camera, shape = depth_camera(WIDTH, HEIGHT), (HEIGHT, WIDTH)
    origins, directions = camera_rays(camera, pose[None])
    if scene.room is None:
        distance = first_hits(rendered, origins, directions)
        along = directions @ pose[:3, 2].astype(np.float32)
        z = np.where(np.isfinite(distance), distance, 0.0) * along
    else:
        forward = np.broadcast_to(pose[:3, 2], directions.shape)
        sight = room_sight(rendered, scene.room, origins, directions, forward)
        z = sight.depth.astype(np.float32)
    normals = first_normals(rendered, origins, directions)
    cosines = np.abs(np.einsum("ij,ij->i", normals, directions))
    exact = z.reshape(shape).astype(np.float32)
    depth = sensor.measured(exact, cosines.reshape(shape), camera, rng)
    # Whole millimetres, as depth images hold.
    return np.asarray(np.rint(depth * 1000.0) / 1000.0, np.float32)


def _true_faces(
    rendered: Any, positions: NDArray[np.float32], normals: NDArray[np.float32]
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Face of the mesh nearest to each voxel along its normal, and whether there is one."""
    origins = positions + np.float32(NEAR_TRUTH) * normals
    distance, faces, is_object = first_faces(rendered, origins, -normals)
    return faces, is_object & (distance < 2 * NEAR_TRUTH)


def _frames_of(
    view_centres: NDArray[np.float32], tracked: NDArray[np.float64]
) -> NDArray[np.int64]:
    """Index (W',) of the frame that each stored view was taken from: their centres are the same."""
    frames = {pose[:3, 3].astype(np.float32).tobytes(): k for k, pose in enumerate(tracked)}
    return np.array([frames[centre.tobytes()] for centre in view_centres], np.int64)
