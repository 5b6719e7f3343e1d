# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How far estimates move when what should not matter changes, in stated standard deviations."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from tqdm import tqdm

from reflest_core.capture.frame import Frame
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import FrameRefused
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.pipeline import KeyframeSnapshot, Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.evaluation.networks import EvaluationError
from reflest_core.surface.selection import keep_voxels

KEPT = 0.7
"""Share of the frames, or of the voxels, that a subset holds."""
SUBSETS = 4
VOXEL_SIZES = (0.003, 0.005, 0.008)
"""Metres."""
FOLDS, LEFT_OUT = 10, 3
"""Equal parts that the frames are divided in, and how many of them are left out, one at a time."""
POSE_ERROR = 1e-4
"""Metres and radians, standard deviation along each axis and about it."""
SEED = 20
CAPTURE_FILE = "metadata.yaml"
"""A folder that holds it is a rosbag2 capture."""


def find_captures(folder: Path) -> list[Path]:
    """Return the rosbag2 captures in a folder, by name; the folder itself if it is one.

    Args:
        folder: where captures are looked for.

    Raises:
        EvaluationError: There are none.
    """
    if (folder / CAPTURE_FILE).exists():
        return [folder]
    found = sorted(path.parent for path in folder.glob(f"*/{CAPTURE_FILE}"))
    if not found:
        raise EvaluationError(
            f"{folder} holds no captures: the part stability needs a folder of rosbag2 captures, "
            "such as 'reflest synbrdf sequence' writes"
        )
    return found


def measure_stability(
    captures: Sequence[Path], settings: ReflestSettings | None = None
) -> dict[str, Any]:
    """Estimate each capture again with parts left out and small errors added.

    Args:
        captures: Captures of one object each.
        settings: Of the scans; the defaults if None.

    Returns:
        ``captures``: names. ``ratios``: by kind of change (C, 5), the root mean square distance of
        the changed estimates from their mean (of subsets and voxel sizes) or from the unchanged
        estimate (of the others), divided by the standard deviation that it states. NaN where the
        network states none. ``medians``: by kind (5,), over captures.
    """
    settings = settings or ReflestSettings()
    of_captures = [
        _ratios(list(open_capture(path)), settings)
        for path in tqdm(captures, desc="stability", unit="capture", leave=False)
    ]
    kinds = list(of_captures[0])
    ratios = {kind: np.stack([of[kind] for of in of_captures]) for kind in kinds}
    return {
        "captures": [path.name for path in captures],
        "kept": KEPT,
        "subsets": SUBSETS,
        "ratios": {kind: of.tolist() for kind, of in ratios.items()},
        "medians": {kind: np.median(of, axis=0).tolist() for kind, of in ratios.items()},
    }


def _ratios(frames: list[Frame], settings: ReflestSettings) -> dict[str, NDArray[np.float64]]:
    """(5,) by kind of change, of one capture."""
    pipeline, snapshot = _scanned(frames, settings)
    base = pipeline.estimate(snapshot)
    stddev = np.array([*base.rho_d_stddev, base.rho_s_stddev, base.alpha_stddev])

    def again(changed: list[Frame], with_settings: ReflestSettings = settings) -> BrdfEstimate:
        other, found = _scanned(changed, with_settings)
        return other.estimate(found)

    def of_voxels(rng: np.random.Generator) -> BrdfEstimate:
        surface = snapshot.surface
        chosen = np.flatnonzero(rng.random(surface.voxel_count) < KEPT)
        return pipeline.estimate(
            dataclasses.replace(snapshot, surface=keep_voxels(surface, chosen))
        )

    folds = np.random.default_rng(SEED).permutation(len(frames)) % FOLDS
    around_mean = {
        "70 % of frames": [
            again([frame for frame in frames if rng.random() < KEPT]) for rng in _seeds()
        ],
        "70 % of voxels": [of_voxels(rng) for rng in _seeds()],
        "voxels of 3, 5, 8 mm": [again(frames, _with_voxels(settings, s)) for s in VOXEL_SIZES],
    }
    around_base = {
        "one grey level": [again([_brighter(frame) for frame in frames])],
        "another tenth of frames left out": [
            again([frame for frame, fold in zip(frames, folds, strict=True) if fold != left_out])
            for left_out in range(LEFT_OUT)
        ],
        "poses by 1e-4": [again([_moved(frame, rng) for frame in frames]) for rng in _seeds(2)],
    }
    found = {}
    for kind, made in around_mean.items():
        found[kind] = _ward(made).std(axis=0, ddof=1) / stddev
    for kind, made in around_base.items():
        found[kind] = np.sqrt(((_ward(made) - _ward([base])) ** 2).mean(axis=0)) / stddev
    return found


def _scanned(frames: list[Frame], settings: ReflestSettings) -> tuple[Pipeline, KeyframeSnapshot]:
    """A scan that is taken for one material, as with a region of interest."""
    pipeline = Pipeline(settings)
    for frame in frames:
        try:
            pipeline.fuse(frame)
        except FrameRefused:
            continue
    return pipeline, dataclasses.replace(pipeline.snapshot(), middle=None, around=None)


def _seeds(count: int = SUBSETS) -> Iterator[np.random.Generator]:
    return (np.random.default_rng([SEED, number]) for number in range(count))


def _with_voxels(settings: ReflestSettings, size: float) -> ReflestSettings:
    return dataclasses.replace(
        settings, fusion=dataclasses.replace(settings.fusion, voxel_size=size)
    )


def _brighter(frame: Frame) -> Frame:
    """All colours one level up, but white."""
    rgb = frame.rgb + (frame.rgb < 255).astype(np.uint8)
    return dataclasses.replace(frame, rgb=rgb)


def _moved(frame: Frame, rng: np.random.Generator) -> Frame:
    """A small error of its own in the frame's pose."""
    error = np.eye(4)
    error[:3, :3] = Rotation.from_rotvec(POSE_ERROR * rng.normal(size=3)).as_matrix()
    error[:3, 3] = POSE_ERROR * rng.normal(size=3)
    return dataclasses.replace(frame, T_world_camera=frame.T_world_camera @ error)


def _ward(estimates: list[BrdfEstimate]) -> NDArray[np.float64]:
    """(N, 5)."""
    return np.array([[*one.rho_d, one.rho_s, one.alpha] for one in estimates])
