# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Published materials beside the true ones: which is which, and a table of both."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reflest_core.brdf.parameters import WardParameters
from reflest_core.estimation.estimate import BrdfEstimate

NEAR = 0.01
"""Metres between a published voxel and the point of the true surface that it shows."""
SMALLEST_SHARE = 0.01
"""Of the true points; what was seen less is left out."""


@dataclass(frozen=True)
class MatchedMaterial:
    """A true material and the published one that covers most of it.

    Attributes:
        part: What it covers: the table or an object.
        truth: True Ward parameters, linear sRGB; rho_d is the mean over what was seen.
        id: Of the published material.
        estimate: Of the published material.
        share: Of the true material's voxels, those that have this id.
    """

    part: str
    truth: WardParameters
    id: int
    estimate: BrdfEstimate
    share: float


def match_materials(
    truth: dict[str, Any],
    points: NDArray[np.void],
    voxels: NDArray[np.void],
    estimates: dict[int, BrdfEstimate],
) -> list[MatchedMaterial]:
    """Find each true material among the published ones.

    Args:
        truth: The content of ``truth.json``.
        points: The content of ``truth.ply``: ``x y z material_id`` of the true surface.
        voxels: The published cloud, ``x y z material_id``.
        estimates: Published materials by id.

    Returns:
        The true materials that were seen and found, in the order of ``truth``.
    """
    tree = cKDTree(np.stack([points[axis] for axis in "xyz"], axis=-1))
    places = np.stack([voxels[axis] for axis in "xyz"], axis=-1)
    distance, nearest = tree.query(places)
    true_ids = np.where(distance < NEAR, points["material_id"][nearest].astype(np.int64), -1)
    matched = []
    for material in truth["materials"]:
        ids = voxels["material_id"][true_ids == material["id"]]
        known = ids[np.isin(ids, list(estimates))]
        if material["seen_share"] < SMALLEST_SHARE or not len(known):
            continue
        values, counts = np.unique(known, return_counts=True)
        best = int(values[counts.argmax()])
        red, green, blue = material["rho_d_mean"]
        ward = WardParameters((red, green, blue), material["rho_s"], material["alpha"])
        share = float(counts.max() / len(ids))
        matched.append(MatchedMaterial(material["part"], ward, best, estimates[best], share))
    return matched


def material_table(matched: list[MatchedMaterial]) -> str:
    """The comparison as lines of text; ± stands before one standard deviation.

    Args:
        matched: True materials with their estimates.
    """
    lines = [f"  {'':<10}{'':<9}{'rho_d, linear sRGB':<25}{'rho_s':<16}{'alpha':<16}status"]
    for one in matched:
        true, found = one.truth, one.estimate
        lines.append(
            f"  {one.part:<10}{'truth':<9}{_colour(true.rho_d):<25}"
            f"{true.rho_s:<16.3f}{true.alpha:<16.3f}"
        )
        lines.append(
            f"  {'':<10}{f'id {one.id}':<9}{_colour(found.rho_d, found.rho_d_stddev):<25}"
            f"{f'{found.rho_s:.3f} ± {found.rho_s_stddev:.3f}':<16}"
            f"{f'{found.alpha:.3f} ± {found.alpha_stddev:.3f}':<16}{found.status.name}"
        )
    return "\n".join(lines)


def _colour(
    rho_d: tuple[float, float, float], stddev: tuple[float, float, float] | None = None
) -> str:
    values = " ".join(f"{value:.2f}" for value in rho_d)
    return values if stddev is None else f"{values} ± {max(stddev):.2f}"
