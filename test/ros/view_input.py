# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A keyframe and an estimate to show."""

from __future__ import annotations

import dataclasses

import numpy as np

from reflest_core.estimation.estimate import SCHEMA_VERSION, BrdfEstimate, EstimateStatus
from reflest_core.estimation.pipeline import KeyframeSnapshot
from reflest_core.surface.observed_surface import ObservedSurface

STAMP_NS = 12_000_000_034

ESTIMATE = BrdfEstimate(
    stamp_ns=1_750_000_000_123_456_789,
    frame_id="camera",
    schema_version=SCHEMA_VERSION,
    model_id="hemicnn/0",
    ward_variant="ward-1992",
    rho_d=(0.1, 0.2, 0.3),
    rho_s=0.04,
    alpha=0.15,
    lab=(50.0, -3.0, 7.0),
    c=0.2,
    d=0.85,
    voxel_count=70_000,
    observation_count=3_000_000,
    view_count=300,
    coverage=0.4,
    status=EstimateStatus.LOW_COVERAGE,
    status_text="move",
    alpha_stddev=0.01,
    latency=0.2,
)


def keyframe(voxels: int = 500, pose: np.ndarray | None = None) -> KeyframeSnapshot:
    """A plane of voxels at z = 0, each with one to four observations of its own colour."""
    rng = np.random.default_rng(3)
    positions = np.zeros((voxels, 3), np.float32)
    positions[:, :2] = rng.uniform(-0.1, 0.1, (voxels, 2))
    counts = 1 + np.arange(voxels) % 4
    offsets = np.concatenate([[0], np.cumsum(counts)])
    colours = rng.integers(0, 256, (voxels, 3)).astype(np.uint8)
    surface = ObservedSurface(
        positions=positions,
        normals=np.tile(np.array([0, 0, 1], np.float32), (voxels, 1)),
        offsets=offsets,
        colours=np.repeat(colours, counts, axis=0),
        view_indices=np.zeros(offsets[-1], np.uint16),
        view_centres=np.array([[0, 0, 1]], np.float32),
        view_foreground=np.full((1, 3), 100, np.float32),
        view_background=np.full((1, 3), 100, np.float32),
    )
    return KeyframeSnapshot(
        STAMP_NS, "camera", surface, "map", looking_down() if pose is None else pose
    )


def looking_down(height: float = 1.0) -> np.ndarray:
    """T_world_camera of a camera above the plane that looks at it."""
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[2, 3] = height
    return pose


def estimate(**changes: object) -> object:
    """``ESTIMATE`` with other values."""
    return dataclasses.replace(ESTIMATE, **changes)
