# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Materials as measurements find them: weakly glossy, often dark, seldom near a mirror.

OpenSurfaces' space (:mod:`.materials`) spreads contrast and roughness evenly. Ward fits of measured
BRDFs do not: Ngan, Durand & Matusik, "Experimental Analysis of BRDF Models", EGSR 2005, fitted the
MERL materials, most of them with ``rho_s`` below 0.1. The families here follow such fits and are
wider: plastics and paints, satin things, dark and black ones, metals, cloth and paper.
"""

from __future__ import annotations

import colorsys
import csv
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from reflest_core.brdf.lab import luminance
from reflest_core.brdf.parameters import WardParameters
from reflest_core.errors import ReflestError

FIT_ALPHAS = (0.005, 0.35)
"""Fits with a roughness outside are left out: sharper than a scan resolves, or shading in truth."""
COLUMNS = ("material", "rho_d_r", "rho_d_g", "rho_d_b", "rho_s_r", "rho_s_g", "rho_s_b", "alpha")


class MaterialFitsUnreadable(ReflestError):
    """A table of fitted materials cannot be used."""


@dataclass(frozen=True)
class Family:
    """A kind of material, each parameter drawn evenly in its logarithm within a range.

    Attributes:
        share: Of all materials.
        albedo: Largest channel of ``rho_d``, linear.
        saturation: Of ``rho_d`` in HSV, drawn evenly.
        rho_s: Specular albedo.
        alpha: Roughness.
    """

    share: float
    albedo: tuple[float, float]
    saturation: tuple[float, float]
    rho_s: tuple[float, float]
    alpha: tuple[float, float]


FAMILIES = {
    "plastic": Family(0.24, (0.03, 0.85), (0.0, 0.95), (0.01, 0.06), (0.01, 0.08)),
    "paint": Family(0.20, (0.05, 0.85), (0.0, 0.8), (0.005, 0.05), (0.02, 0.15)),
    "satin": Family(0.18, (0.04, 0.7), (0.0, 0.8), (0.01, 0.15), (0.08, 0.25)),
    "dark": Family(0.16, (0.004, 0.05), (0.0, 0.6), (0.01, 0.06), (0.01, 0.2)),
    "metal": Family(0.10, (0.01, 0.2), (0.0, 0.6), (0.1, 0.5), (0.02, 0.2)),
    "cloth": Family(0.12, (0.03, 0.8), (0.0, 0.9), (0.01, 0.15), (0.18, 0.35)),
}
"""By name; the shares add up to 1."""


def draw_measured(rng: np.random.Generator) -> tuple[WardParameters, str]:
    """Draw a material of a family.

    Args:
        rng: Source of the draw; equal states give equal materials.

    Returns:
        The material and its family's name.
    """
    names = list(FAMILIES)
    name = names[int(rng.choice(len(names), p=[FAMILIES[key].share for key in names]))]
    family = FAMILIES[name]
    albedo = _log_uniform(rng, family.albedo)
    colour = colorsys.hsv_to_rgb(rng.uniform(), rng.uniform(*family.saturation), 1.0)
    rho_s, alpha = _log_uniform(rng, family.rho_s), _log_uniform(rng, family.alpha)
    return _within_energy(albedo * np.array(colour), rho_s, alpha), name


def fits_bytes(path: Path) -> bytes:
    """Read the file of a table of fits as it is.

    Args:
        path: A .csv file.

    Raises:
        MaterialFitsUnreadable: If it cannot be read.
    """
    try:
        return path.read_bytes()
    except OSError as error:
        raise MaterialFitsUnreadable(f"{path} cannot be read as a .csv table: {error}") from error


def read_fits(path: Path) -> dict[str, WardParameters]:
    """Read Ward fits from a table, in its order.

    Args:
        path: A .csv file with the columns :data:`COLUMNS`: linear sRGB, Ward 1992.

    Returns:
        Materials by name. ``rho_s`` is the Rec. 709 luminance of its three values, and all albedos
        are scaled down where they add up to more than 1. Fits outside :data:`FIT_ALPHAS` are left
        out.

    Raises:
        MaterialFitsUnreadable: If the file is missing, lacks a column, or holds no usable fit.
    """
    try:
        text = fits_bytes(path).decode("utf-8")
        rows = list(csv.DictReader(io.StringIO(text, newline="")))
    except (UnicodeDecodeError, csv.Error) as error:
        raise MaterialFitsUnreadable(f"{path} cannot be read as a .csv table: {error}") from error
    fits: dict[str, WardParameters] = {}
    for number, row in enumerate(rows, start=2):
        lacking = [column for column in COLUMNS if row.get(column) is None]
        if lacking:
            raise MaterialFitsUnreadable(
                f"{path} has no {', '.join(lacking)} in line {number}: give a table with the "
                f"columns {', '.join(COLUMNS)}"
            )
        name, values = row["material"], _numbers(path, number, row)
        if FIT_ALPHAS[0] <= values[6] <= FIT_ALPHAS[1]:
            name = name if name not in fits else f"{name}-{number}"
            rho_s = float(luminance(values[3:6]))
            fits[name] = _within_energy(values[:3], rho_s, float(values[6]))
    if not fits:
        raise MaterialFitsUnreadable(
            f"{path} holds no fit with alpha from {FIT_ALPHAS[0]} to {FIT_ALPHAS[1]}"
        )
    return fits


def _numbers(path: Path, number: int, row: dict[str, str]) -> np.ndarray:
    try:
        values = np.array([float(row[column]) for column in COLUMNS[1:]])
    except ValueError as error:
        raise MaterialFitsUnreadable(f"{path}, line {number}: {error}") from error
    if not (np.isfinite(values).all() and (values >= 0.0).all()):
        raise MaterialFitsUnreadable(f"{path}, line {number}: values must be finite and 0 or more")
    return values


def _log_uniform(rng: np.random.Generator, bounds: tuple[float, float]) -> float:
    return float(np.exp(rng.uniform(*np.log(bounds))))


def _within_energy(rho_d: np.ndarray, rho_s: float, alpha: float) -> WardParameters:
    excess = max(float(rho_d.max()) + rho_s, 1.0)
    red, green, blue = (float(albedo) for albedo in rho_d / excess)
    return WardParameters((red, green, blue), rho_s / excess, alpha)
