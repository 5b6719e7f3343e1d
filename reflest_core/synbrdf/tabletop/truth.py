# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Truth of a scene of many materials: ``truth.json`` and a point cloud ``truth.ply``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.gloss import to_labcd
from reflest_core.ply_file import write_ply
from reflest_core.synbrdf.scenes.painted_mesh import PaintedMesh
from reflest_core.synbrdf.scenes.scene_materials import SceneMaterial
from reflest_core.synbrdf.sequences.sequence_truth import TRUTH

FORMAT = "synbrdf-sv-truth-1"
CLOUD = "truth.ply"
POINT = np.dtype(
    [
        *((name, "<f4") for name in ("x", "y", "z", "nx", "ny", "nz")),
        *((name, "<f4") for name in ("rho_d_r", "rho_d_g", "rho_d_b", "rho_s", "alpha")),
        ("views", "<u2"),
        ("material_id", "<u4"),
    ]
)
"""A point of the cloud: as ``reflest replay --materials`` writes it, without deviations."""


def truth_points(
    painted: PaintedMesh,
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    faces: NDArray[np.int64],
    views: NDArray[np.int64],
) -> NDArray[np.void]:
    """Points with their materials.

    Args:
        painted: The scene's surfaces.
        positions: (P, 3) metres, world frame.
        normals: (P, 3) unit.
        faces: (P,) index of each point's face.
        views: (P,) number of frames that see the point.

    Returns:
        (P,) of :data:`POINT`.
    """
    points = np.zeros(len(positions), POINT)
    points["x"], points["y"], points["z"] = positions.T
    points["nx"], points["ny"], points["nz"] = normals.T
    points["rho_d_r"], points["rho_d_g"], points["rho_d_b"] = painted.rho_d[faces].T
    points["rho_s"], points["alpha"] = painted.rho_s[faces], painted.alpha[faces]
    points["views"], points["material_id"] = views, painted.material_of_face[faces]
    return points


def write_cloud(path: Path, points: NDArray[np.void]) -> None:
    """Write (P,) of :data:`POINT` as a binary little-endian PLY file.

    Args:
        path: the file.
        points: (P,) of :data:`POINT`.
    """
    with path.open("wb") as file:
        write_ply(file, {"vertex": points})


def material_cards(painted: PaintedMesh, points: NDArray[np.void]) -> list[dict[str, Any]]:
    """A card of each material, by id.

    Args:
        painted: The scene's surfaces.
        points: (P,) of :data:`POINT`, those that are seen, spread evenly over the surface.
    """
    return [
        _card(number, material, points[points["material_id"] == number], len(points))
        for number, material in enumerate(painted.materials)
    ]


def _card(
    number: int, material: SceneMaterial, points: NDArray[np.void], count: int
) -> dict[str, Any]:
    ward, labcd = material.ward, to_labcd(material.ward)
    mean = [
        float(points[f"rho_d_{channel}"].mean()) if len(points) else ward.rho_d[k]
        for k, channel in enumerate("rgb")
    ]
    return {
        "id": number,
        "part": material.part,
        "source": material.source,
        "name": material.name,
        "texture": material.texture,
        "ward_variant": ward.variant.value,
        "rho_d": ward.rho_d,
        "rho_d_mean": mean,
        "rho_s": ward.rho_s,
        "alpha": ward.alpha,
        "lab": labcd.lab,
        "c": labcd.c,
        "d": labcd.d,
        "seen_share": len(points) / max(count, 1),
    }


def write_truth(folder: Path, card: dict[str, Any], points: NDArray[np.void]) -> None:
    """Write both files. The estimator never opens them.

    Args:
        folder: Of the bag.
        card: What ``truth.json`` says besides its format.
        points: (P,) of :data:`POINT`.
    """
    write_cloud(folder / CLOUD, points)
    text = json.dumps({"format": FORMAT, **card}, indent=1)
    (folder / TRUTH).write_text(text + "\n")
