# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Materials of scanned scenes to train ``lightnet`` on: as they are found, in their joint light.

A material that a scan was divided into is impure, partial, and stands in a light that is known from
all others. So a scene is scanned as a robot would scan it, and each material that is found gives
the features that an estimate would have.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Iterator
from concurrent.futures import as_completed
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from tqdm import tqdm

from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import FrameRefused
from reflest_core.estimation.estimator import NoEstimate
from reflest_core.estimation.material_map import MaterialMap
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.scene_estimates import SceneEstimates
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.inference.material import explain_material
from reflest_core.models.lightnet import VOXELS
from reflest_core.models.lightnet.features import LightFeatures, features_of_choices
from reflest_core.models.linear_algebra import one_blas_thread
from reflest_core.models.predictor import CHOICES, dealt
from reflest_core.ply_file import read_vertices
from reflest_core.source_fingerprint import source_fingerprint
from reflest_core.surface.upright import upright
from reflest_core.surface.voxel_choice import choose_voxels
from reflest_core.synbrdf.generation.process_pool import process_pool
from reflest_core.synbrdf.sequences.sequence_truth import TRUTH
from reflest_core.synbrdf.tabletop.truth import CLOUD
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.light.scan_file import ScanCard, as_row, read_cards, save_scans

NEAR = 0.01
"""Metres from a voxel to its true point."""
PUREST, FEWEST = 0.7, 30
"""A material is learned from if so large a share of its voxels, and so many of them, are of one
true material."""
SHARES = (0.5, 1.0)
"""Of a scene's frames, after which its materials are taken: scans are short as well as long."""


def scan_scenes(folder: Path, out: Path, jobs: int) -> list[Path]:
    """Scan the scenes of a folder that have not been scanned yet, a file for each.

    Args:
        folder: Holds bags of ``reflest synbrdf tabletop``.
        out: Folder for the materials of several such folders.
        jobs: Processes.

    Returns:
        The files of all scenes, by name.

    Raises:
        TrainingError: There is no scene, or a file was made by other code or of another scene.
    """
    scenes = sorted(path.parent for path in folder.glob(f"*/{CLOUD}"))
    if not scenes:
        raise TrainingError(
            f"{folder} holds no scanned scene with a {CLOUD}: make some with "
            "'reflest synbrdf tabletop', each in a folder of its own there"
        )
    place = out / folder.resolve().name / "materials"
    place.mkdir(parents=True, exist_ok=True)
    paths = [place / f"{scene.name}.safetensors" for scene in scenes]
    missing = []
    for number, (scene, path) in enumerate(zip(scenes, paths, strict=True)):
        if path.exists():
            read_cards(path, _fingerprint(scene))
        else:
            missing.append((number, scene, path))
    if not missing:
        return paths
    with (
        process_pool(min(jobs, len(missing))) as pool,
        tqdm(
            total=len(scenes), initial=len(scenes) - len(missing), unit="scene", desc="scanning"
        ) as bar,
    ):
        futures = [pool.submit(_scan, *one) for one in missing]
        try:
            for future in as_completed(futures):
                if refused := future.result():
                    bar.write(refused)
                bar.update()
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
    return paths


def _scan(number: int, scene: Path, path: Path) -> str:
    """Write the materials of one scene; return why there are none, or ""."""
    card = json.loads((scene / TRUTH).read_text())
    truth = read_vertices(scene / CLOUD)
    rows, cards = [], []
    for frames, found in _maps(scene):
        with one_blas_thread():
            for ward, features in learned_materials(found, truth):
                row = as_row(features)
                if all(np.isfinite(array).all() for array in row.values()):
                    rows.append(row)
                    cards.append(ScanCard(ward, frames, number, card["environment"]))
    save_scans(path, rows, cards, _fingerprint(scene))
    return "" if rows else f"{scene.name} is left out: no material was found in it"


def _maps(scene: Path) -> Iterator[tuple[int, MaterialMap]]:
    """The number of frames and the materials that were found, for each of :data:`SHARES`."""
    pipeline = Pipeline(ReflestSettings())
    capture = open_capture(scene)
    frames = list(capture)
    ends = [round(share * len(frames)) for share in SHARES]
    for done, frame in enumerate(frames, start=1):
        try:
            pipeline.fuse(frame)
        except FrameRefused as refusal:
            capture.refuse(refusal)
        if done in ends:
            try:
                yield done, pipeline.final_materials()
            except NoEstimate:
                continue


def learned_materials(
    found: MaterialMap, truth: NDArray[np.void]
) -> Iterator[tuple[list[float], LightFeatures]]:
    """Yield the true Ward parameters and the features of each material that is pure enough.

    Args:
        found: The materials of a scan that the network sees the light of.
        truth: (P,) points of the scene's surfaces, with their materials.
    """
    light, settings = found.light, ReflestSettings().estimation
    if light is None or light.joint is None:
        return
    turned = upright(found.surface, settings.up)
    scene = SceneEstimates(turned, light, settings.gloss_voxels, settings.gloss_information)
    places = np.stack([truth[axis] for axis in "xyz"], axis=1)
    distance, nearest = cKDTree(places).query(found.surface.world_positions)
    true_ids = np.where(distance < NEAR, truth["material_id"][nearest].astype(np.int64), -1)
    ids = found.material_ids
    for material_id, part in found.partition.parts(turned):
        voxels = np.flatnonzero(ids == material_id)
        known = voxels[true_ids[voxels] >= 0]
        if len(known) < FEWEST or material_id not in light.evidence:
            continue
        true_id = np.bincount(true_ids[known]).argmax()
        if (true_ids[known] == true_id).mean() < PUREST:
            continue
        explained = dataclasses.replace(
            explain_material(light, material_id), posterior=scene.posterior(voxels)
        )
        ward = _true_ward(truth, nearest[known], int(true_id))
        chosen = choose_voxels(part, CHOICES * VOXELS)
        if len(chosen) < CHOICES * VOXELS:
            chosen = choose_voxels(part, VOXELS)
        for features in features_of_choices(explained, dealt(chosen, VOXELS)):
            yield ward, features


def _true_ward(truth: NDArray[np.void], points: NDArray[np.int64], true_id: int) -> list[float]:
    """The mean albedo of the points, and the gloss of the true material that most are of."""
    albedo = [float(truth[f"rho_d_{channel}"][points].mean()) for channel in "rgb"]
    of_material = truth[truth["material_id"] == true_id][0]
    return [*albedo, float(of_material["rho_s"]), float(of_material["alpha"])]


def _fingerprint(scene: Path) -> str:
    """Hash (hex) of the code that scans and of the scene's truth."""
    sources = source_fingerprint("reflest_core.training.light.scanned_materials")
    return hashlib.sha256(f"{sources} {(scene / TRUTH).read_text()}".encode()).hexdigest()
