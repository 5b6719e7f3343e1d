# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scans of whole scenes against their truth: the part ``materials``.

A scene is a bag of ``reflest synbrdf tabletop`` with ``truth.ply`` and ``truth.json`` beside it. It
is replayed without a region, as a robot would scan it.
"""

from __future__ import annotations

import dataclasses
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from tqdm import tqdm

from reflest_core.brdf.lab import luminance
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import FrameRefused
from reflest_core.environment.environment_map import from_octahedral
from reflest_core.estimation.estimator import NoEstimate
from reflest_core.estimation.material_map import MaterialMap
from reflest_core.estimation.pipeline import EVERY_VOXEL, Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.statistics.map_stability import Change, change_between
from reflest_core.evaluation.statistics.material_clouds import (
    MATCHED_WITHIN,
    CloudErrors,
    compare_clouds,
    read_cloud,
)
from reflest_core.export.material_ply import material_vertices
from reflest_core.fusion.snapshot import MATERIAL_VOXELS
from reflest_core.rendering.environments import irradiance
from reflest_core.surface.partition import Partition
from reflest_core.surface.selection import keep_voxels
from reflest_core.synbrdf.lights.environments import find_environments, load_environment, rotated

TRUTH = "truth.ply"
NORMALS = 200
"""Directions that the irradiance is compared on."""
VARIANTS = ("materials", "true_segments", "alone", "whole")
"""As the node estimates; with the true segments; each material in light inferred from it alone; all
as one."""
MEANS = ("z", "rmse", "log_rho_d", "ari", "balanced_ari", "purity", "completeness", "matched")


def find_tables(folder: Path) -> list[Path]:
    """The scenes in a folder, by name.

    Args:
        folder: Holds a bag in each of its folders.

    Raises:
        EvaluationError: There is none with a truth.
    """
    found = sorted(path.parent for path in folder.glob(f"*/{TRUTH}"))
    if not found:
        raise EvaluationError(
            f"{folder} holds no scene with a {TRUTH}; make some with 'reflest synbrdf tabletop'"
        )
    return found


def measure_materials(
    scenes: list[Path], limit: int | None = None, environments: Path | None = None
) -> dict[str, Any]:
    """Replay every scene and compare its materials with the truth.

    Args:
        scenes: Folders of bags with a truth.
        limit: Only the first so many; None for all.
        environments: The environments that the scenes were generated with, for the error of the
            light; None leaves it out.

    Returns:
        The record of the part ``materials``: a row for each scene, and means over the scenes.
    """
    rows = []
    for scene in tqdm(scenes[:limit], desc="scenes", unit="scene", leave=False):
        rows.append(_measure(scene, environments))
    known = [row["irradiance"] for row in rows if row["irradiance"] is not None]
    found = [row["materials"] for row in rows]
    return {
        "scenes": len(rows),
        "means": {
            variant: {name: float(np.mean([row[variant][name] for row in rows])) for name in MEANS}
            for variant in VARIANTS
        },
        "inside": np.nanmean([one["inside"] for one in found], axis=0).tolist(),
        "irradiance": None if not known else float(np.mean(known)),
        "kept": _mean([row["kept"] for row in rows]),
        "small_steps": _mean([row["small_steps"] for row in rows]),
        "rows": rows,
    }


def _measure(scene: Path, environments: Path | None) -> dict[str, Any]:
    truth, card = read_cloud(scene / TRUTH), _card(scene)
    pipeline = Pipeline(ReflestSettings())
    maps = []
    capture = open_capture(scene)
    for frame in capture:
        try:
            scanned = pipeline.fuse(frame)
        except FrameRefused as refusal:
            capture.refuse(refusal)
            continue
        if scanned.keyframe is not None:
            try:
                maps.append(pipeline.materials(pipeline.snapshot(MATERIAL_VOXELS)))
            except NoEstimate:
                continue
    snapshot = pipeline.snapshot(EVERY_VOXEL)
    if snapshot.memory is not None:
        snapshot.memory.last = None  # what costs nothing to answer again is not to be timed
    started = time.process_time()
    final = pipeline.materials(snapshot)
    seconds = time.process_time() - started
    changes = [
        change
        for before, after in zip(maps[len(maps) // 2 :], maps[len(maps) // 2 + 1 :], strict=False)
        if (change := change_between(before, after)) is not None
    ]
    return {
        "name": scene.name,
        "setting": f"{card.get('setting', 'unknown')}, {card.get('light', 'unknown')} light",
        "voxels": final.surface.voxel_count,
        "cpu_seconds": seconds,
        "materials": dataclasses.asdict(_errors(final, truth)),
        "whole": dataclasses.asdict(_errors(_as_one(pipeline, final), truth)),
        "alone": dataclasses.asdict(_errors(_each_alone(pipeline, final), truth)),
        "true_segments": dataclasses.asdict(_errors(_true_segments(pipeline, final, truth), truth)),
        "irradiance": irradiance_error(final, card, environments),
        "kept": _mean([change.kept for change in changes]),
        "small_steps": _small_steps(changes),
    }


def _errors(found: MaterialMap, truth: NDArray[np.void]) -> CloudErrors:
    return compare_clouds(material_vertices(found), truth)


def _as_one(pipeline: Pipeline, found: MaterialMap) -> MaterialMap:
    """The same scan as one material."""
    surface = found.surface
    return pipeline.estimator.materials(
        surface, Partition.whole(surface), found.stamp_ns, found.frame_id
    )


def _each_alone(pipeline: Pipeline, found: MaterialMap) -> MaterialMap:
    """The same materials, each estimated in light inferred from it alone."""
    rho_d, stddev = np.full_like(found.rho_d, np.nan), np.full_like(found.rho_d, np.nan)
    ids, materials = found.material_ids, []
    for material in found.materials:
        voxels = np.flatnonzero(ids == material.id)
        part = keep_voxels(found.surface, voxels)
        try:
            estimate = pipeline.estimator.estimate(part, found.stamp_ns, found.frame_id)
        except NoEstimate:
            continue
        rho_d[voxels], stddev[voxels] = estimate.rho_d, estimate.rho_d_stddev
        materials.append(dataclasses.replace(material, estimate=estimate))
    return dataclasses.replace(found, materials=tuple(materials), rho_d=rho_d, rho_d_stddev=stddev)


def _true_segments(pipeline: Pipeline, found: MaterialMap, truth: NDArray[np.void]) -> MaterialMap:
    """The same scan divided by the truth; what lies far from every true point is one more."""
    places = np.stack([truth[axis] for axis in "xyz"], axis=1)
    distance, nearest = cKDTree(places).query(found.surface.positions)
    true_ids = truth["material_id"].astype(np.int64)
    ids = np.where(distance <= MATCHED_WITHIN, 1 + true_ids[nearest], 2 + true_ids.max())
    return pipeline.estimator.materials(
        found.surface, Partition.of(found.surface, ids), found.stamp_ns, found.frame_id
    )


def _card(scene: Path) -> dict[str, Any]:
    path = scene / "truth.json"
    try:
        card: dict[str, Any] = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise EvaluationError(f"{path} cannot be read ({error})") from error
    return card


def irradiance_error(
    found: MaterialMap, card: dict[str, Any], environments: Path | None
) -> float | None:
    """Error of the inferred light: RMS of the log ratio of irradiance on surfaces that face up.

    Args:
        found: The materials of a scan, z up.
        card: The scene's ``truth.json``.
        environments: The environments that the scene was generated with, or None.

    Returns:
        The error of the luminance; None without environments or under near light.

    Raises:
        EvaluationError: The scene's environment is not among them.
    """
    if environments is None or found.light is None or card.get("light") != "distant":
        return None
    sources = {source.name: source for source in find_environments(environments)}
    if card["environment"] not in sources:
        raise EvaluationError(
            f"{environments} has no {card['environment']}: give the environments of the scenes"
        )
    radiance = load_environment(sources[card["environment"]])
    true = rotated(radiance, card["environment_rotation"]) * np.float32(card["exposure"])
    estimated = from_octahedral(found.light.completed.levels[0]).radiance
    normals = np.random.default_rng(0).normal(size=(NORMALS, 3))
    normals[:, 2] = np.abs(normals[:, 2])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    one, other = (luminance(irradiance(light, normals)) for light in (estimated, true))
    ratio = np.log(np.maximum(one, 1e-9) / np.maximum(other, 1e-9))
    return float(np.sqrt((ratio**2).mean()))


def _small_steps(changes: list[Change]) -> float:
    """Share of materials that move by less than a stated deviation from keyframe to keyframe."""
    steps = [step for change in changes for step in change.steps]
    return float(np.mean([step < 1.0 for step in steps])) if steps else float("nan")


def _mean(values: list[float]) -> float:
    known = [value for value in values if np.isfinite(value)]
    return float(np.mean(known)) if known else float("nan")
