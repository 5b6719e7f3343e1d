# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The materials of a scan against the truth, point by point, as ``reflest replay --materials``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reflest_core.brdf.lab import luminance
from reflest_core.brdf.parameters import RHO_D
from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.statistics.segmentation import (
    adjusted_rand_index,
    balanced,
    completeness,
    contingency,
    purity,
)
from reflest_core.models.card import WARD_NAMES
from reflest_core.ply_file import read_vertices

SPREAD = np.array([0.25, 0.25, 0.25, 0.20, 0.06])
"""Of materials, in ``rho_d`` r g b, ``rho_s``, ``alpha``: errors are divided by it."""
MATCHED_WITHIN = 0.008
"""Metres from a true point to the nearest voxel."""
LEAST_POINTS = 100
"""A true material of fewer matched points is not judged."""
LEAST_ALBEDO = 1e-3
"""Luminances are raised to it before their logarithms are compared."""
INTERVAL = NormalDist().inv_cdf(0.95)
"""Half the width of a 90 % interval, in standard deviations."""
PROPERTIES = ("rho_d_r", "rho_d_g", "rho_d_b", "rho_s", "alpha")


@dataclass(frozen=True)
class CloudErrors:
    """Errors of the materials of one scan.

    Attributes:
        z: Mean over true materials of the mean over their points of the RMS over the five Ward
            parameters of error / :data:`SPREAD`.
        rmse: Root of the mean over true materials of the mean of these squares.
        per_parameter: (5,) the same root for each parameter.
        log_rho_d: Median of ``|log|`` of the ratio of luminances of ``rho_d``, materials weighted
            alike.
        ari: Adjusted Rand index, points weighted alike.
        balanced_ari: Adjusted Rand index, true materials weighted alike.
        purity: True materials weighted alike.
        completeness: True materials weighted alike.
        matched: Share of the true points with a voxel nearby.
        materials: Number of true materials that are judged.
        found: Number of materials that were found at their points.
        inside: (5,) share of points whose truth lies in the voxel's 90 % interval, materials
            weighted alike; NaN where no deviation is stated.
        z_by_material: ``z`` of each judged material, by its true id.
    """

    z: float
    rmse: float
    per_parameter: list[float]
    log_rho_d: float
    ari: float
    balanced_ari: float
    purity: float
    completeness: float
    matched: float
    materials: int
    found: int
    inside: list[float]
    z_by_material: dict[int, float]


def read_cloud(path: Path) -> NDArray[np.void]:
    """The vertices of a PLY file of materials.

    Args:
        path: Written by ``reflest replay --materials``, or a truth of ``reflest synbrdf tabletop``.

    Raises:
        EvaluationError: It cannot be read, or it lacks a property.
    """
    try:
        vertices = read_vertices(path)
    except (OSError, ValueError) as error:
        raise EvaluationError(f"{path} is not a PLY file of materials ({error})") from error
    needed = {"x", "y", "z", *PROPERTIES, "material_id"}
    missing = sorted(needed - set(vertices.dtype.names or ()))
    if missing:
        raise EvaluationError(f"{path} has no property {', '.join(missing)}")
    return vertices


def compare_clouds(found: NDArray[np.void], truth: NDArray[np.void]) -> CloudErrors:
    """Compare found with true materials.

    Each true point is matched with the nearest voxel. A voxel without an estimate counts as one
    with an unknown material: it gets the worst of 1 in each parameter's normalised error.

    Args:
        found: (V,) records with the properties of ``reflest replay --materials``.
        truth: (P,) records with positions, Ward values and ``material_id``.

    Raises:
        EvaluationError: No true material has enough points near the scan.
    """
    distance, nearest = cKDTree(_places(found)).query(_places(truth))
    is_near = distance <= MATCHED_WITHIN
    counts = np.bincount(truth["material_id"][is_near])
    judged = np.flatnonzero(counts >= LEAST_POINTS)
    if not len(judged):
        raise EvaluationError("the scan shows no true material: are both in the same world frame?")
    chosen = is_near & np.isin(truth["material_id"], judged)
    true, made = truth[chosen], found[nearest[chosen]]
    errors = (_ward(made) - _ward(true)) / SPREAD
    errors = np.where(np.isfinite(errors), errors, 1.0)
    ids = true["material_id"]
    squared, z = errors**2, np.sqrt((errors**2).mean(axis=1))
    by_material = {int(one): float(z[ids == one].mean()) for one in judged}
    table = contingency(ids, made["material_id"])
    return CloudErrors(
        z=float(np.mean(list(by_material.values()))),
        rmse=float(np.sqrt(_over_materials(squared.mean(axis=1), ids, judged))),
        per_parameter=[
            float(np.sqrt(_over_materials(column, ids, judged))) for column in squared.T
        ],
        log_rho_d=_balanced_median(_log_ratio(made, true), ids, judged),
        ari=adjusted_rand_index(table),
        balanced_ari=adjusted_rand_index(balanced(table)),
        purity=purity(balanced(table)),
        completeness=completeness(balanced(table)),
        matched=float(is_near.mean()),
        materials=len(judged),
        found=table.shape[1],
        inside=_inside(made, true, judged),
        z_by_material=by_material,
    )


def report(errors: CloudErrors) -> list[str]:
    """Lines for a terminal.

    Args:
        errors: Of one scan.
    """
    per_parameter = ", ".join(
        f"{name} {value:.2f}" for name, value in zip(WARD_NAMES, errors.per_parameter, strict=True)
    )
    return [
        f"z {errors.z:.3f} (mean over {errors.materials} materials), RMSE {errors.rmse:.3f}: "
        f"{per_parameter}",
        f"median |log rho_d| {errors.log_rho_d:.3f}",
        f"adjusted Rand index {errors.ari:.3f}, materials weighted alike {errors.balanced_ari:.3f}",
        f"purity {errors.purity:.3f}, completeness {errors.completeness:.3f}, {errors.found} found",
        f"{errors.matched:.0%} of the true points were scanned",
    ]


def _places(records: NDArray[np.void]) -> NDArray[np.float64]:
    return np.stack([records[axis] for axis in "xyz"], axis=1).astype(np.float64)


def _ward(records: NDArray[np.void], suffix: str = "") -> NDArray[np.float64]:
    return np.stack([records[name + suffix] for name in PROPERTIES], axis=1).astype(np.float64)


def _over_materials(
    values: NDArray[Any], ids: NDArray[np.integer], judged: NDArray[np.integer]
) -> float:
    """Mean over materials of the mean over their points."""
    return float(np.mean([values[ids == one].mean() for one in judged]))


def _log_ratio(made: NDArray[np.void], true: NDArray[np.void]) -> NDArray[np.float64]:
    """``|log|`` of the ratio of luminances; infinite where there is no estimate."""
    values = [np.maximum(luminance(_ward(one)[:, RHO_D]), LEAST_ALBEDO) for one in (made, true)]
    ratio = np.abs(np.log(values[0] / values[1]))
    return np.where(np.isfinite(ratio), ratio, np.inf)


def _balanced_median(
    values: NDArray[np.float64], ids: NDArray[np.integer], judged: NDArray[np.integer]
) -> float:
    """Median of values whose materials weigh alike."""
    counts = np.bincount(ids, minlength=int(judged.max()) + 1)
    order = np.argsort(values)
    weights = np.cumsum(1.0 / counts[ids[order]])
    return float(values[order][np.searchsorted(weights, 0.5 * weights[-1])])


def _inside(
    made: NDArray[np.void], true: NDArray[np.void], judged: NDArray[np.integer]
) -> list[float]:
    if "alpha_stddev" not in (made.dtype.names or ()):
        return [float("nan")] * len(PROPERTIES)
    names = [f"rho_d_{channel}_stddev" for channel in "rgb"] + ["rho_s_stddev", "alpha_stddev"]
    deviations = np.stack([made[name] for name in names], axis=1).astype(np.float64)
    is_inside = np.abs(_ward(made) - _ward(true)) <= INTERVAL * deviations
    shares = []
    for column in range(len(PROPERTIES)):
        known = np.isfinite(deviations[:, column])
        some = [
            is_inside[known & (true["material_id"] == one), column].mean()
            for one in judged
            if (known & (true["material_id"] == one)).any()
        ]
        shares.append(float(np.mean(some)) if some else float("nan"))
    return shares
