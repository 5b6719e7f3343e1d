# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One picture of the demo on a table: photograph, model, and spheres of every material."""

from __future__ import annotations

from pathlib import Path

from reflest_core.brdf.parameters import WardParameters
from reflest_core.capture.frame import Frame
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.rendering.standing_sphere import standing_sphere
from reflest_core.viewer.lights import Light
from reflest_ros.demo.matched_materials import MatchedMaterial
from reflest_ros.demo.model import Model
from reflest_ros.demo.sheet import Sheet
from reflest_ros.demo.shipped_capture import ward_parameters

WIDTH, HEIGHT = 16.0, 8.5
MARGIN, GAP, TOP = 0.4, 0.12, 1.3
INK, FAINT, PAPER = "#1d1d1f", "#6b6b70", "#fbfaf8"
IMAGE_WIDTH = 960
"""Pixels of the model's pictures."""
SPHERE = 220
MOST_MATERIALS = 5
"""Pairs of spheres that fit beside each other."""


def draw_table(path: Path, frame: Frame, model: Model, matched: list[MatchedMaterial]) -> None:
    """Write the PNG.

    Args:
        path: the file.
        frame: of the capture; the model is drawn from its camera.
        model: the scan with its materials.
        matched: true and estimated materials.
    """
    sheet = Sheet(WIDTH, HEIGHT, PAPER, INK)
    sheet.write(MARGIN, 0.55, "reflest", fontsize=26, weight="bold")
    line = "the materials of everything that a robot scans, estimated while it scans"
    sheet.write(2.6, 0.55, line, fontsize=16, color=FAINT)
    width = (WIDTH - 2 * MARGIN - 2 * GAP) / 3
    height = width * frame.rgb.shape[0] / frame.rgb.shape[1]
    pictures = {
        "a frame of the scan": frame.rgb,
        "its model: materials in the estimated light": model.seen_from(
            frame, IMAGE_WIDTH, Light.ESTIMATED
        ),
        "the same model in a studio": model.seen_from(frame, IMAGE_WIDTH, Light.STUDIO),
    }
    for column, (title, picture) in enumerate(pictures.items()):
        left = MARGIN + column * (width + GAP)
        sheet.write(left, TOP - 0.14, title, color=FAINT)
        sheet.show(left, TOP, width, height, picture)
    _draw_spheres(sheet, matched[:MOST_MATERIALS], TOP + height + 0.55)
    sheet.save(path)


def _draw_spheres(sheet: Sheet, matched: list[MatchedMaterial], top: float) -> None:
    """Pairs of spheres, truth and estimate, with their numbers below."""
    cell = (WIDTH - 2 * MARGIN - (len(matched) - 1) * 2 * GAP) / max(len(matched), 1)
    side = min(cell / 2, HEIGHT - top - 0.75)
    for column, one in enumerate(matched):
        left = MARGIN + column * (cell + 2 * GAP)
        name = one.part.replace("-", " ")
        sheet.write(left, top - 0.14, name, color=INK, weight="bold")
        estimated = ward_parameters(one.estimate.to_json())
        for place, (title, ward) in enumerate((("truth", one.truth), ("estimate", estimated))):
            start = left + place * side
            sheet.show(start, top, side, side, standing_sphere(ward, SPHERE))
            sheet.write(start + 0.06, top + 0.22, title, fontsize=10, color="#ffffff")
            text = _numbers(ward, one.estimate if place else None)
            sheet.write(start, top + side + 0.24, text, fontsize=9.5, va="top")


def _numbers(ward: WardParameters, estimate: BrdfEstimate | None) -> str:
    red, green, blue = ward.rho_d
    gloss = ("", "")
    if estimate is not None:
        gloss = (f" ± {estimate.rho_s_stddev:.3f}", f" ± {estimate.alpha_stddev:.2f}")
    return (
        f"rho_d  {red:.2f} {green:.2f} {blue:.2f}\n"
        f"rho_s  {ward.rho_s:.3f}{gloss[0]}\nalpha  {ward.alpha:.2f}{gloss[1]}"
    )
