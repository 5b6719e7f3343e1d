# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the colours of the surface mean, and the legend that says so."""

from __future__ import annotations

import enum
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.rendering.material_labels import material_colour
from reflest_core.rendering.voxel_colours import UNKNOWN
from reflest_core.viewer.shown_scan import NO_MATERIAL, ShownScan

VIRIDIS = np.array(
    [
        [68, 1, 84],
        [72, 40, 120],
        [62, 74, 137],
        [49, 104, 142],
        [38, 130, 142],
        [31, 158, 137],
        [53, 183, 121],
        [110, 206, 88],
        [181, 222, 43],
        [253, 231, 37],
    ]
)
"""The colour map of van der Walt and Smith 2015: even to the eye, also to a colour-blind one."""
LEAST_SPAN = 0.02
"""Values closer together are not spread over the whole map: that would show noise."""


class ColourMode(enum.Enum):
    """A mode by the name that the page shows."""

    RENDERED = "Materials in the light"
    OBSERVED = "Observed colour"
    ALBEDO = "Diffuse albedo"
    SPECULAR = "Specular albedo rho_s"
    ROUGHNESS = "Roughness alpha"
    MATERIAL = "Material id"
    ALBEDO_DEVIATION = "Deviation of the albedo"
    SPECULAR_DEVIATION = "Deviation of rho_s"
    ROUGHNESS_DEVIATION = "Deviation of alpha"
    COVERAGE = "Coverage of view directions"


OF_ESTIMATES = {
    ColourMode.SPECULAR: "rho_s",
    ColourMode.ROUGHNESS: "alpha",
    ColourMode.SPECULAR_DEVIATION: "rho_s_stddev",
    ColourMode.ROUGHNESS_DEVIATION: "alpha_stddev",
}


@dataclass(frozen=True)
class Colouring:
    """Colours of all vertices.

    Attributes:
        colours: (N, 3) uint8 sRGB.
        legend: HTML that explains them.
    """

    colours: NDArray[np.uint8]
    legend: str


def modes_of(scan: ShownScan) -> tuple[ColourMode, ...]:
    """The modes that a scan has values for.

    Args:
        scan: what is shown.
    """
    missing = {
        *([] if scan.has_colours else [ColourMode.OBSERVED]),
        *([] if scan.has_observations else [ColourMode.COVERAGE]),
    }
    return tuple(mode for mode in ColourMode if mode not in missing)


def coloured(scan: ShownScan, mode: ColourMode) -> Colouring:
    """Colour the vertices by a mode that does not depend on light or camera.

    Args:
        scan: what is shown.
        mode: any but :attr:`ColourMode.RENDERED`.
    """
    if mode is ColourMode.OBSERVED:
        return Colouring(scan.observed, "Mean of what the camera saw, highlights included.")
    if mode is ColourMode.ALBEDO:
        encoded = 255.0 * srgb.encode(np.nan_to_num(scan.rho_d))
        known = np.isfinite(scan.rho_d)
        colours = np.where(known, np.rint(encoded), UNKNOWN).astype(np.uint8)
        return Colouring(colours, "rho_d as a colour: no shading, no highlights.")
    if mode is ColourMode.MATERIAL:
        return _by_material(scan)
    if mode is ColourMode.COVERAGE:
        return mapped(scan.coverage, 0.0, 1.0, "{:.0%}")
    if mode is ColourMode.ALBEDO_DEVIATION:
        deviation = scan.found.rho_d_stddev.mean(axis=1)[scan.voxel_of]
        known = np.where(scan.material_ids == NO_MATERIAL, np.float32(np.nan), deviation)
        return _over_own_range(known)
    return _over_own_range(scan.of_materials(OF_ESTIMATES[mode]))


def mapped(values: NDArray[np.float32], low: float, high: float, digits: str) -> Colouring:
    """Map values to :data:`VIRIDIS`; unknown ones are grey.

    Args:
        values: (N,), NaN where unknown.
        low: the value of the darkest colour.
        high: the value of the brightest.
        digits: how the legend's numbers are written, for ``str.format``.
    """
    place = np.clip((np.nan_to_num(values) - low) / (high - low), 0.0, 1.0) * (len(VIRIDIS) - 1)
    knots = np.arange(len(VIRIDIS))
    channels = [np.interp(place, knots, VIRIDIS[:, channel]) for channel in range(3)]
    colours = np.stack(channels, axis=-1)
    colours[~np.isfinite(values)] = UNKNOWN
    steps = ",".join(f"rgb({red},{green},{blue})" for red, green, blue in VIRIDIS)
    ends = "".join(
        f"<span>{digits.format(value)}</span>" for value in (low, (low + high) / 2, high)
    )
    unknown = "<div style='opacity:.7'>grey: unknown</div>" if np.isnan(values).any() else ""
    gradient = f"linear-gradient(90deg,{steps})"
    legend = (
        f"<div style='height:.8em;border-radius:3px;background:{gradient}'></div>"
        f"<div style='display:flex;justify-content:space-between'>{ends}</div>{unknown}"
    )
    return Colouring(np.rint(colours).astype(np.uint8), legend)


def _over_own_range(values: NDArray[np.float32]) -> Colouring:
    """From 0 to the largest value that is not an outlier."""
    known = values[np.isfinite(values)]
    high = float(np.quantile(known, 0.99)) if len(known) else 0.0
    return mapped(values, 0.0, max(high, LEAST_SPAN), "{:.3f}")


def _by_material(scan: ShownScan) -> Colouring:
    ids = scan.material_ids
    known, place = np.unique(ids, return_inverse=True)
    colours = np.array([material_colour(int(one)) for one in known], np.uint8)[place.reshape(-1)]
    patches = "".join(
        f"<span style='white-space:nowrap;margin-right:.8em'>{patch(material_colour(one.id))}"
        f"&nbsp;{one.id}</span> "
        for one in scan.found.materials
    )
    return Colouring(colours, f"{patches}<div style='opacity:.7'>grey: no material yet</div>")


def patch(rgb: tuple[int, int, int], size: str = ".8em") -> str:
    """A square of one colour in HTML.

    Args:
        rgb: 8-bit sRGB.
        size: edge as a CSS length.
    """
    return (
        f"<span style='display:inline-block;width:{size};height:{size};border-radius:3px;"
        f"border:1px solid #8888;vertical-align:-.1em;background:rgb{rgb}'></span>"
    )
