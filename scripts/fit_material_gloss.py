#!/usr/bin/env python3
# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Fit the regressions of ``reflest_core/inference/material_gloss.py``.

    python scripts/fit_material_gloss.py TABLES

TABLES holds bags of ``reflest synbrdf tabletop --materials measured``. Prints the coefficients and
the errors on scans that were left out of the fit.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree
from tqdm import tqdm

from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.pipeline import EVERY_VOXEL, Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.evaluation.statistics.material_clouds import read_cloud
from reflest_core.evaluation.studies.table_scenes import TRUTH, find_tables
from reflest_core.inference.gloss.view_changes import view_changes
from reflest_core.inference.light import infer_light, seen_light
from reflest_core.inference.material import explain_material
from reflest_core.inference.material_gloss import LEAST
from reflest_core.inference.transport.surface_irradiance import SurfaceSight, surface_irradiance
from reflest_core.surface.upright import upright

NEAR, PUREST, FEWEST = 0.01, 0.7, 30
"""Metres from a voxel to its true point; share of a material that is one true one; its voxels."""
RIDGE = 4.0
SPREAD = 2.5
"""Standard deviations at which cues are held."""


def rows_of(scene: Path) -> list[dict[str, Any]]:
    """The cues of gloss of each material of a scan beside the truth."""
    pipeline = Pipeline(ReflestSettings())
    for frame in open_capture(scene):
        pipeline.fuse(frame)
    found = pipeline.materials(pipeline.snapshot(EVERY_VOXEL))
    estimator, surface = pipeline.estimator, found.surface
    turned = upright(surface, estimator.settings.up)
    assert found.light is not None
    assert found.light.joint is not None
    light = infer_light(turned, seen_light(turned), found.partition, joint=found.light.joint)
    sight = SurfaceSight.of(turned.positions, turned.normals, light.occluders)
    irradiance = surface_irradiance(light.completed, sight)[:, :3]
    truth = read_cloud(scene / TRUTH)
    card = json.loads((scene / "truth.json").read_text())
    places = np.stack([truth[axis] for axis in "xyz"], axis=1)
    distance, nearest = cKDTree(places).query(surface.positions)
    true_ids = np.where(distance < NEAR, truth["material_id"][nearest].astype(np.int64), -1)
    ids, rows = found.material_ids, []
    for material_id, part in found.partition.parts(turned):
        voxels = np.flatnonzero(ids == material_id)
        known = true_ids[voxels][true_ids[voxels] >= 0]
        if len(known) < FEWEST or material_id not in light.evidence:
            continue
        true_id = int(np.bincount(known).argmax())
        changes = view_changes(turned, voxels)
        if (known == true_id).mean() < PUREST or changes is None:
            continue
        network = estimator.predictor.predict(part, explain_material(light, material_id)).ward
        of_truth = next(one for one in card["materials"] if one["id"] == true_id)
        rho_s = [light.joint.gloss_of(voxels)[0], network[3]]
        change = np.log(changes.far_change / max(float(irradiance[voxels].mean()), 1e-6))
        of_network = float(np.log(np.clip(network[4], 0.02, 0.4)))
        rows.append(
            {
                "scene": scene.name,
                "material": true_id,
                "voxels": len(voxels),
                "alpha": of_truth["alpha"],
                "strength": float(np.log(of_truth["rho_s"] + LEAST)),
                "alpha_cues": [changes.blur, changes.peakedness, changes.over_noise, of_network],
                "strength_cues": [*np.log(np.clip(rho_s, 0.0, 1.0) + LEAST), change],
            }
        )
    return rows


def fit(rows: list[dict[str, Any]], target: str) -> None:
    """Print the regression of a target on its cues."""
    y = np.array([row[target] for row in rows])
    cues = np.array([row[f"{target}_cues"] for row in rows])
    scenes = np.array([row["scene"] for row in rows])
    materials = [(row["scene"], row["material"]) for row in rows]
    totals = {
        one: sum(row["voxels"] for row, other in zip(rows, materials, strict=True) if one == other)
        for one in set(materials)
    }
    weight = np.array(
        [row["voxels"] / totals[one] for row, one in zip(rows, materials, strict=True)]
    )
    mean = np.average(cues, axis=0, weights=weight)
    deviation = np.sqrt(np.average((cues - mean) ** 2, axis=0, weights=weight))
    scores = np.clip((cues - mean) / deviation, -SPREAD, SPREAD)
    columns = np.concatenate([np.ones((len(y), 1)), scores], axis=1)
    ridge = np.diag([0.0] + [RIDGE] * cues.shape[1])

    def solved(chosen: np.ndarray) -> np.ndarray:
        x, w = columns[chosen], weight[chosen]
        return np.linalg.solve((x.T * w) @ x + ridge, (x.T * w) @ y[chosen])

    left_out = np.zeros(len(y))
    for scene in np.unique(scenes):
        left_out[scenes == scene] = columns[scenes == scene] @ solved(scenes != scene)
    found = solved(np.ones(len(y), bool))
    slopes = found[1:] / deviation
    print(f"{target}: {len(y)} materials of {len(np.unique(scenes))} scans")
    print("  intercept and coefficients", np.round([found[0] - slopes @ mean, *slopes], 4).tolist())
    bounds = np.stack([mean - SPREAD * deviation, mean + SPREAD * deviation], axis=1)
    print("  ranges of the cues", np.round(bounds, 2).tolist())
    for name, error in (
        ("left out", left_out - y),
        ("a constant", np.average(y, weights=weight) - y),
    ):
        print(f"  RMS error, {name}: {np.sqrt(np.average(error**2, weights=weight)):.3f}")


def main() -> None:
    """Collect the materials of all scans and fit."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tables", type=Path, help="a folder of bags with their truth")
    tables = parser.parse_args().tables
    rows = [row for scene in tqdm(find_tables(tables)) for row in rows_of(scene)]
    for target in ("alpha", "strength"):
        fit(rows, target)


if __name__ == "__main__":
    main()
