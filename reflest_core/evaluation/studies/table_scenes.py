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
    compare_clouds,
    read_cloud,
)
from reflest_core.evaluation.studies.scene_variants import VARIANTS, variants
from reflest_core.export.material_ply import material_vertices
from reflest_core.fusion.snapshot import MATERIAL_VOXELS
from reflest_core.rendering.environments import irradiance
from reflest_core.synbrdf.lights.environments import find_environments, load_environment, rotated

TRUTH = "truth.ply"
NORMALS = 200
"""Directions that the irradiance is compared on."""
UNSEEN, TRAINING = "unseen", "training"
SPLITS = (UNSEEN, TRAINING)
"""Scenes under lights that the network was not trained on, and under lights that it was."""
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
        The record of the part ``materials``: a row for each scene, and means over the scenes of
        each split.
    """
    rows = []
    for scene in tqdm(scenes[:limit], desc="scenes", unit="scene", leave=False):
        rows.append(_measure(scene, environments))
    return {
        "splits": {
            name: _summary(of_split)
            for name in SPLITS
            if (of_split := [row for row in rows if row["split"] == name])
        },
        "rows": rows,
    }


def _summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Means over the scenes of one split."""
    lights = {row["environment"] for row in rows}
    known = [row["irradiance"] for row in rows if row["irradiance"] is not None]
    return {
        "scenes": len(rows),
        "lights": len(lights),
        "means": {
            variant: _means([row[variant] for row in rows if variant in row])
            for variant in VARIANTS
            if any(variant in row for row in rows)
        },
        "inside": np.nanmean([row["materials"]["inside"] for row in rows], axis=0).tolist(),
        "irradiance": None if not known else float(np.mean(known)),
        "kept": _mean([row["kept"] for row in rows]),
        "small_steps": _mean([row["small_steps"] for row in rows]),
    }


def _measure(scene: Path, environments: Path | None) -> dict[str, Any]:
    truth, card = read_cloud(scene / TRUTH), _card(scene)
    light = true_light(card, environments)
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
        "environment": card.get("environment", "unknown"),
        "split": TRAINING if card.get("environment") in _training_lights(pipeline) else UNSEEN,
        "setting": f"{card.get('setting', 'unknown')}, {card.get('light', 'unknown')} light",
        "voxels": final.surface.voxel_count,
        "cpu_seconds": seconds,
        **{
            name: dataclasses.asdict(compare_clouds(material_vertices(found), truth))
            for name, found in variants(pipeline.estimator, final, truth, light)
        },
        "irradiance": None if light is None else irradiance_error(final, light),
        "kept": _mean([change.kept for change in changes]),
        "small_steps": _small_steps(changes),
    }


def _training_lights(pipeline: Pipeline) -> list[str]:
    recipe = pipeline.estimator.predictor.card.recipe
    return list(recipe.get("calibrated_under", []))


def _card(scene: Path) -> dict[str, Any]:
    path = scene / "truth.json"
    try:
        card: dict[str, Any] = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise EvaluationError(f"{path} cannot be read ({error})") from error
    return card


def true_light(card: dict[str, Any], environments: Path | None) -> NDArray[np.float32] | None:
    """Read the light that a scene was rendered in.

    Args:
        card: The scene's ``truth.json``.
        environments: The environments that the scene was generated with, or None.

    Returns:
        (H, 2 H, 3) equirectangular, linear, 1 at the sensor's white, turned as in the scene; None
        without environments or under near light.

    Raises:
        EvaluationError: The scene's environment is not among them.
    """
    if environments is None or card.get("light") != "distant":
        return None
    sources = {source.name: source for source in find_environments(environments)}
    if card["environment"] not in sources:
        raise EvaluationError(
            f"{environments} has no {card['environment']}: give the environments of the scenes"
        )
    radiance = load_environment(sources[card["environment"]])
    return rotated(radiance, card["environment_rotation"]) * np.float32(card["exposure"])


def irradiance_error(found: MaterialMap, light: NDArray[np.float32]) -> float | None:
    """Error of the inferred light: RMS of the log ratio of irradiance on surfaces that face up.

    Args:
        found: The materials of a scan, z up.
        light: See :func:`true_light`.

    Returns:
        The error of the luminance; None where the network sees no light.
    """
    if found.light is None:
        return None
    estimated = from_octahedral(found.light.completed.levels[0]).radiance
    normals = np.random.default_rng(0).normal(size=(NORMALS, 3))
    normals[:, 2] = np.abs(normals[:, 2])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    one, other = (luminance(irradiance(radiance, normals)) for radiance in (estimated, light))
    ratio = np.log(np.maximum(one, 1e-9) / np.maximum(other, 1e-9))
    return float(np.sqrt((ratio**2).mean()))


def _means(errors: list[dict[str, Any]]) -> dict[str, float]:
    return {name: float(np.mean([one[name] for one in errors])) for name in MEANS}


def _small_steps(changes: list[Change]) -> float:
    """Share of materials that move by less than a stated deviation from keyframe to keyframe."""
    steps = [step for change in changes for step in change.steps]
    return float(np.mean([step < 1.0 for step in steps])) if steps else float("nan")


def _mean(values: list[float]) -> float:
    known = [value for value in values if np.isfinite(value)]
    return float(np.mean(known)) if known else float("nan")
