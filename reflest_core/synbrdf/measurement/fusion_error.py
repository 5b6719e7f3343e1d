# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How far a fused surface is from the true one, with and without the faults of a depth camera.

Renders hand-held scans, fuses them with the estimator's own ``Scan`` and compares every voxel of
its surface with the mesh. Importing this module loads Mitsuba.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.synbrdf.path_tracing.mitsuba_scene import first_hits, first_normals, mitsuba_scene
from reflest_core.synbrdf.path_tracing.sight import camera_rays
from reflest_core.synbrdf.path_tracing.ward_bsdf import ward_bsdf
from reflest_core.synbrdf.realism.depth_sensor import DepthSensor
from reflest_core.synbrdf.realism.pose_jitter import jittered
from reflest_core.synbrdf.realism.settings import Effect, Realism
from reflest_core.synbrdf.scenes.views import depth_camera
from reflest_core.synbrdf.sequences.sequence_scene import SequenceRequest, draw_sequence_scene

SIGHT = 0.02
"""Metres to either side of a voxel within which the true surface is looked for."""


@dataclass(frozen=True)
class FusionError:
    """Differences between a fused surface and the true one, at V voxels.

    Attributes:
        tilt: (V,) degrees between fused and true normals.
        offset: (V,) metres along the true normals.
    """

    tilt: NDArray[np.float64]
    offset: NDArray[np.float64]

    @classmethod
    def joined(cls, errors: list[FusionError]) -> FusionError:
        """All voxels of several surfaces.

        Args:
            errors: of several scenes.
        """
        return cls(
            np.concatenate([error.tilt for error in errors]),
            np.concatenate([error.offset for error in errors]),
        )

    def quantiles(self) -> dict[str, float]:
        """Median and 90th percentile of the tilt, and the spread of the offset (68 %)."""
        low, high = np.quantile(self.offset, [0.16, 0.84])
        return {
            "tilt_median": float(np.median(self.tilt)),
            "tilt_p90": float(np.quantile(self.tilt, 0.9)),
            "offset_stddev": float(0.5 * (high - low)),
        }


def measure(
    request: SequenceRequest, sensor: DepthSensor, tracking: Realism, voxel_size: float
) -> FusionError:
    """Scan the object of a sequence with exact colour, measured depth and tracked poses.

    Args:
        request: the sequence.
        sensor: the depth camera.
        tracking: faults of poses.
        voxel_size: metres.
    """
    sequence = draw_sequence_scene(request)
    rendered = mitsuba_scene(
        sequence.mesh, ward_bsdf(sequence.material), np.ones((4, 8, 3), np.float32)
    )
    camera = depth_camera(request.width, request.height)
    rng = np.random.default_rng(request.seed)
    poses = sequence.poses
    if tracking.is_on(Effect.POSE):
        poses = jittered(poses, tracking, rng)
    scan = Scan(FusionSettings(voxel_size=voxel_size), RegionSettings())
    rgb = np.full((camera.height, camera.width, 3), 128, np.uint8)
    for number, (true_pose, pose) in enumerate(zip(sequence.poses, poses, strict=True)):
        origins, directions = camera_rays(camera, true_pose[None])
        distance = first_hits(rendered, origins, directions)
        normals = first_normals(rendered, origins, directions)
        hit = np.isfinite(distance)
        forward = true_pose[:3, 2].astype(np.float32)
        z = np.where(hit, np.where(hit, distance, 0.0) * (directions @ forward), 0.0)
        cosines = np.abs(np.einsum("ij,ij->i", normals, directions))
        shape = (camera.height, camera.width)
        depth = sensor.measured(
            z.reshape(shape).astype(np.float32), cosines.reshape(shape), camera, rng
        )
        # Whole millimetres, as depth images hold.
        depth = np.rint(depth * 1000.0).astype(np.float32) / np.float32(1000.0)
        scan.fuse(Frame((number + 1) * 10**8, rgb, depth, pose, camera))
    surface = scan.snapshot()
    seen = surface.observation_counts >= 3
    return _error(rendered, surface.positions[seen], surface.normals[seen])


def _error(
    rendered: object, positions: NDArray[np.float32], normals: NDArray[np.float32]
) -> FusionError:
    """Look along the fused normals for the true surface, from outside inwards."""
    origins = positions + np.float32(SIGHT) * normals
    distance = first_hits(rendered, origins, -normals)
    truth = first_normals(rendered, origins, -normals)
    found = distance < 2 * SIGHT
    cosine = np.einsum("ij,ij->i", truth[found], normals[found]).astype(np.float64)
    tilt = np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return FusionError(tilt, SIGHT - distance[found].astype(np.float64))
