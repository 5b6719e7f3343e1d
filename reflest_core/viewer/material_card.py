# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What the page says about a material, as HTML."""

from __future__ import annotations

import base64
import html
import math

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf.srgb import encode
from reflest_core.environment.environment_map import from_octahedral
from reflest_core.estimation.estimate import BrdfEstimate, EstimateStatus
from reflest_core.estimation.material_map import MaterialEstimate
from reflest_core.rendering.environments import studio
from reflest_core.rendering.material_labels import material_colour
from reflest_core.rendering.sphere import render_environment, tone_map
from reflest_core.viewer.angle_plot import AnglePlot
from reflest_core.viewer.colour_modes import patch
from reflest_core.viewer.shown_scan import ShownScan

SWATCH = 104
"""Pixels of the rendered sphere."""
WORDS = {
    EstimateStatus.UNKNOWN: "unknown",
    EstimateStatus.OK: "no warning",
    EstimateStatus.LOW_COVERAGE: "seen from too few directions",
    EstimateStatus.FEW_VOXELS: "too small a surface so far",
    EstimateStatus.LOW_LIGHT: "too little of the room's light seen",
    EstimateStatus.CLIPPED_LIGHT: "light overexposed",
    EstimateStatus.UNCERTAIN_GLOSS: "gloss uncertain",
    EstimateStatus.INCONSISTENT_POSES: "poses do not fit",
    EstimateStatus.MIXED_MATERIALS: "several materials in one",
}
"""Each status in a few words; a coloured mark beside it says whether it is a warning."""
OBSERVED, MODEL = "#56b4e9", "#e69f00"
"""Colours of the plot that colour-blind eyes distinguish (Okabe and Ito 2008)."""
WIDTH, HEIGHT, LEFT, BOTTOM = 300, 150, 34, 28
"""Of the plot, in pixels; the margins of its axes."""


def swatch(estimate: BrdfEstimate, light: NDArray[np.float32] | None, size: int = SWATCH) -> str:
    """A sphere of the material in the scan's own light, as an ``img`` element.

    Args:
        estimate: the material.
        light: (L, L, 5) of the scan, see :attr:`.ShownScan.light`; None renders in a studio.
        size: pixels along an edge.
    """
    environment = studio(64) if light is None else from_octahedral(light).radiance
    image = tone_map(render_environment(estimate.ward, environment, size))
    return (
        f"<img alt='the material on a sphere' width={size} height={size} "
        f"style='border-radius:6px' src='{png_uri(image)}'>"
    )


def png_uri(image: NDArray[np.uint8]) -> str:
    """A data URI of an image.

    Args:
        image: (H, W, 3) sRGB.
    """
    _, content = cv2.imencode(".png", image[..., ::-1])
    return f"data:image/png;base64,{base64.b64encode(content.tobytes()).decode()}"


def value_rows(estimate: BrdfEstimate) -> list[tuple[str, str, str]]:
    """The Ward values as text: what each is called, and value with one standard deviation.

    Args:
        estimate: the material.

    Returns:
        Symbol, value, meaning.
    """
    names = zip(
        ("rho_d R", "rho_d G", "rho_d B"),
        estimate.rho_d,
        estimate.rho_d_stddev,
        strict=True,
    )
    rows = [
        (name, with_deviation(value, stddev), "diffuse albedo") for name, value, stddev in names
    ]
    return [
        *rows,
        ("rho_s", with_deviation(estimate.rho_s, estimate.rho_s_stddev), "specular albedo"),
        ("alpha", with_deviation(estimate.alpha, estimate.alpha_stddev), "roughness"),
    ]


def with_deviation(value: float, stddev: float) -> str:
    """A value with one standard deviation, where that is known.

    Args:
        value: NaN where unknown.
        stddev: NaN where unknown.
    """
    if math.isnan(value):
        return "unknown"
    return f"{value:.3f}" + ("" if math.isnan(stddev) else f" &plusmn; {stddev:.3f}")


def status_lines(estimate: BrdfEstimate) -> str:
    """The status in words, and each warning with what to do.

    Args:
        estimate: the material.
    """
    is_good = estimate.status is EstimateStatus.OK
    mark = "&#10003;" if is_good else "&#9888;"
    colour = "#009e73" if is_good else "#d55e00"
    lines = "".join(
        f"<li>{html.escape(sentence)}</li>"
        for sentence in filter(None, estimate.status_text.split("; "))
    )
    return f"<div><b style='color:{colour}'>{mark} {WORDS[estimate.status]}</b></div>" + (
        f"<ul style='margin:.2em 0;padding-left:1.2em'>{lines}</ul>" if lines else ""
    )


def colour_of(rho_d: tuple[float, ...]) -> tuple[int, int, int]:
    """An albedo as 8-bit sRGB.

    Args:
        rho_d: linear sRGB.
    """
    red, green, blue = np.rint(255.0 * encode(np.nan_to_num(np.array(rho_d)))).astype(int).tolist()
    return (red, green, blue)


def material_card(
    scan: ShownScan, material: MaterialEstimate, vertex: int, plot: AnglePlot | None
) -> str:
    """Everything about the material under a click.

    Args:
        scan: what is shown.
        material: of its map.
        vertex: that was clicked.
        plot: the observations there.
    """
    estimate = material.estimate
    voxel = int(scan.voxel_of[vertex])
    here, deviation = scan.found.rho_d[voxel], scan.found.rho_d_stddev[voxel]
    rows = "".join(
        f"<tr><td title='{meaning}'>{name}</td>"
        f"<td style='text-align:right;font-variant-numeric:tabular-nums'>{value}</td></tr>"
        for name, value, meaning in value_rows(estimate)
    )
    error = material.photometric_error
    facts = [
        f"{1e4 * material.area:.1f} cm&sup2;",
        f"{material.voxel_count:,} voxels",
        f"{estimate.view_count} views",
        f"{estimate.coverage:.0%} of directions",
    ]
    if math.isfinite(error):
        facts.append(f"its rendering differs from the images by {error:.0%}")
    at_click = ", ".join(
        with_deviation(float(value), float(stddev))
        for value, stddev in zip(here, deviation, strict=True)
    )
    return (
        f"<div style='font-size:1.15em'>{patch(material_colour(material.id))} "
        f"<b>Material {material.id}</b> {patch(colour_of(estimate.rho_d))}</div>"
        f"<div style='display:flex;gap:.8em;align-items:flex-start;margin:.4em 0'>"
        f"{swatch(estimate, scan.light)}<table class='reflest-values'>{rows}</table></div>"
        f"{status_lines(estimate)}"
        f"<div style='opacity:.75'>{' &middot; '.join(facts)}</div>"
        f"<div style='opacity:.75'>rho_d at the click: {at_click}</div>"
        f"{plot_svg(plot) if plot else ''}"
    )


def plot_svg(plot: AnglePlot) -> str:
    """The observations over angle against the model.

    Args:
        plot: of a voxel.
    """
    most = max(float(plot.degrees.max()), 10.0)
    top = 1.15 * max(float(plot.observed.max()), float(plot.model.max()), 0.02)
    across, down = WIDTH - LEFT - 8, HEIGHT - BOTTOM - 8

    def place(degrees: float, value: float) -> str:
        return f"{LEFT + across * degrees / most:.1f},{8 + down * (1.0 - value / top):.1f}"

    dots = "".join(
        "<circle cx='{}' cy='{}' r='2.6'/>".format(*place(float(x), float(y)).split(","))
        for x, y in zip(plot.degrees, plot.observed, strict=True)
    )
    line = " ".join(
        place(float(x), float(y)) for x, y in zip(plot.degrees, plot.model, strict=True)
    )
    ticks = "".join(
        f"<text x='{LEFT + across * share:.0f}' y='{HEIGHT - 15}' text-anchor='{anchor}'>"
        f"{most * share:.0f}&deg;</text>"
        for share, anchor in ((0.0, "middle"), (0.5, "middle"), (1.0, "end"))
    ) + "".join(
        f"<text x='{LEFT - 4}' y='{12 + down * (1.0 - share):.0f}' text-anchor='end'>"
        f"{top * share:.2f}</text>"
        for share in (0.0, 0.5, 1.0)
    )
    return (
        "<div style='margin-top:.6em'>"
        f"<span style='color:{OBSERVED}'>&#9679;</span> luminance observed here, "
        f"<span style='color:{MODEL}'>&#8212;</span> the material in the same views</div>"
        f"<svg class='reflest-plot' viewBox='0 0 {WIDTH} {HEIGHT}' width='100%' "
        "style='font-size:10px' fill='currentColor'>"
        f"<path d='M{LEFT} 8V{8 + down}H{LEFT + across}' fill='none' stroke='currentColor' "
        f"stroke-opacity='.5'/>{ticks}"
        f"<polyline points='{line}' fill='none' stroke='{MODEL}' stroke-width='1.6'/>"
        f"<g fill='{OBSERVED}' fill-opacity='.9'>{dots}</g>"
        f"<text x='{LEFT + across}' y='{HEIGHT - 3}' text-anchor='end'>"
        "angle from the mirrored brightest light</text>"
        "</svg>"
    )
