# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One picture of the demo: the scan, and spheres of the true and the estimated material."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from reflest_core.brdf.parameters import WardParameters
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.rendering.environments import studio
from reflest_core.rendering.sphere import render_environment, render_point_light, tone_map
from reflest_ros.demo.comparison import ComparedParameter
from reflest_ros.demo.sheet import Sheet
from reflest_ros.demo.shipped_capture import ward_parameters

LIGHTS = {"left": (-0.85, -0.6, 0.45), "front": (0.15, -0.9, 0.6), "right": (0.9, -0.25, 0.35)}
"""Directions towards the point light; the camera looks along +y."""
STUDIO_EXPOSURE, LIGHT_EXPOSURE = 0.8, 0.9
SPHERE = 250
"""Pixels on a side."""

# The page, in inches; lengths are measured from its left and its top.
WIDTH, HEIGHT = 16.0, 7.5
MARGIN, TOP = 0.45, 1.35
COLUMN = 4.4
SPHERES_LEFT, SIDE, GAP = 5.45, 2.5, 0.06
INK, FAINT, LINE, PAPER = "#f4f3f0", "#9b9ba3", "#333338", "#000000"


def draw(
    path: Path,
    frame: NDArray[np.uint8],
    truth: WardParameters,
    estimate: BrdfEstimate,
    compared: list[ComparedParameter],
    capture: str,
) -> None:
    """Write the PNG. ``frame`` is (H, W, 3) 8-bit sRGB of the scan.

    Args:
        path: the file.
        frame: (H, W, 3) a colour image.
        truth: the material's true values.
        estimate: the keyframe's estimate.
        compared: parameters with truth and estimate.
        capture: its name.
    """
    sheet = Sheet(WIDTH, HEIGHT, PAPER, INK)
    sheet.write(MARGIN, 0.55, "reflest", fontsize=26, weight="bold", color=INK)
    subtitle = "the reflectance of a surface, estimated while it is scanned"
    sheet.write(SPHERES_LEFT, 0.55, subtitle, fontsize=16, color=FAINT)

    height = COLUMN * frame.shape[0] / frame.shape[1]
    sheet.write(MARGIN, TOP - 0.16, f"from a frame of the scan “{capture}”", color=FAINT)
    sheet.show(MARGIN, TOP, COLUMN, height, frame)
    table_top = TOP + height + 0.2
    table = sheet.axes(MARGIN, table_top, COLUMN, HEIGHT - table_top - 0.3)
    _show_table(table, compared)

    for row, material in enumerate((truth, ward_parameters(estimate.to_json()))):
        top = TOP + row * (SIDE + GAP)
        for column, (light, picture) in enumerate(_pictures(material).items()):
            left = SPHERES_LEFT + column * (SIDE + GAP)
            sheet.show(left, top, SIDE, SIDE, picture)
            if row == 0:
                sheet.write(left, TOP - 0.16, light, color=FAINT)
    for row, name in enumerate(("truth", "estimate")):
        middle = TOP + row * (SIDE + GAP) + SIDE / 2
        sheet.write(
            SPHERES_LEFT - 0.22,
            middle,
            name,
            fontsize=16,
            weight="bold",
            color=INK,
            rotation=90,
            ha="center",
            va="center",
        )
    sheet.write(SPHERES_LEFT, TOP + 2 * SIDE + GAP + 0.4, _basis(estimate), color=FAINT)
    sheet.save(path)


def _basis(estimate: BrdfEstimate) -> str:
    return (
        f"{estimate.model_id}, Ward variant {estimate.ward_variant}; from {estimate.view_count} "
        f"views, {estimate.voxel_count:,} voxels, {estimate.observation_count:,} observations"
    )


def _pictures(material: WardParameters) -> dict[str, NDArray[np.uint8]]:
    """8-bit sRGB pictures of a sphere of ``material`` under every light, by the light's name."""
    in_studio = render_environment(material, studio(), SPHERE)
    pictures = {"a studio, not in the scan": tone_map(in_studio, STUDIO_EXPOSURE)}
    for name, direction in LIGHTS.items():
        linear = render_point_light(material, direction, SPHERE)
        pictures[f"point light, {name}"] = tone_map(linear, LIGHT_EXPOSURE)
    return pictures


def _show_table(axes: Axes, compared: list[ComparedParameter]) -> None:
    axes.set_axis_off()
    axes.set_xlim(0, 1)
    axes.set_ylim(len(compared) + 1, 0)
    places = (0.0, 0.44, 0.64, 0.82, 1.0)
    for place, heading in zip(places, ("", "truth", "estimate", "±", "error"), strict=True):
        axes.text(place, 0.5, heading, color=FAINT, fontsize=12, ha="right", va="center")
    for row, one in enumerate(compared, start=1):
        axes.axhline(row, color=LINE, linewidth=0.8)
        axes.text(0.0, row + 0.5, one.name, color=INK, fontsize=11.5, va="center")
        values = (
            f"{one.truth:.3f}",
            f"{one.estimate:.3f}",
            one.deviation.removeprefix("±"),
            f"{one.error:+.3f}",
        )
        for place, value in zip(places[1:], values, strict=True):
            axes.text(
                place,
                row + 0.5,
                value,
                color=INK,
                fontsize=11.5,
                ha="right",
                va="center",
                family="DejaVu Sans Mono",
            )
