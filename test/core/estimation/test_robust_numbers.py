# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Errors too small to matter hardly move an estimate, in its own standard deviations."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings

CAPTURE = Path(__file__).parents[3] / "captures" / "glossy-red"
FRAMES = list(open_capture(CAPTURE))


def estimated(frames):
    pipeline = Pipeline(ReflestSettings())
    for frame in frames:
        pipeline.fuse(frame)
    found = pipeline.estimate(pipeline.snapshot())
    values = np.array([*found.rho_d, found.rho_s, found.alpha])
    return values, np.array([*found.rho_d_stddev, found.rho_s_stddev, found.alpha_stddev])


def with_pose_errors(rng):
    for frame in FRAMES:
        error = np.eye(4)
        error[:3, :3] = Rotation.from_rotvec(1e-4 * rng.normal(size=3)).as_matrix()
        error[:3, 3] = 1e-4 * rng.normal(size=3)
        yield dataclasses.replace(frame, T_world_camera=frame.T_world_camera @ error)


def with_noisy_colours(rng):
    for frame in FRAMES:
        noise = rng.integers(-1, 2, frame.rgb.shape)
        rgb = np.clip(frame.rgb + noise, 0, 255).astype(np.uint8)
        yield dataclasses.replace(frame, rgb=rgb)


def without_a_tenth(rng):
    folds = rng.permutation(len(FRAMES)) % 10
    return [frame for frame, fold in zip(FRAMES, folds, strict=True) if fold]


@pytest.fixture(scope="module")
def unchanged():
    return estimated(FRAMES)


@pytest.mark.parametrize(
    ("change", "limit"),
    [(with_pose_errors, 0.3), (with_noisy_colours, 0.15), (without_a_tenth, 0.4)],
)
def test_estimates_move_by_a_fraction_of_their_deviations(unchanged, change, limit):
    """Roughness by less than a fifth, albedo and strength by less than ``limit``."""
    values, deviations = unchanged
    moved = [estimated(change(np.random.default_rng(seed)))[0] for seed in range(2)]
    roots = np.sqrt((((np.array(moved) - values) / deviations) ** 2).mean(axis=0))
    assert roots[4] < 0.2
    assert np.sqrt((roots[:4] ** 2).mean()) < limit
