# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The report: photograph, model, materials, light and warnings in one HTML file."""

from __future__ import annotations

import base64
import html
import json
import math
from collections.abc import Sequence
from importlib.resources import files
from string import Template

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core import __version__
from reflest_core.brdf import srgb
from reflest_core.capture.frame import Frame
from reflest_core.environment.environment_map import from_octahedral, nothing_seen
from reflest_core.environment.picture import tone_mapped
from reflest_core.estimation.material_map import MaterialEstimate, MaterialMap
from reflest_core.light.octahedral import octahedral_solid_angles
from reflest_core.rendering.material_labels import (
    CameraView,
    labels_over,
    material_colour,
    voxels_in_image,
)
from reflest_core.surface.upright import rotation_to_z
from reflest_core.viewer.colour_modes import patch
from reflest_core.viewer.material_card import (
    WORDS,
    colour_of,
    png_uri,
    swatch,
    with_deviation,
)
from reflest_core.viewer.report.model_data import model_data
from reflest_core.viewer.shading import Shading
from reflest_core.viewer.shown_scan import ShownScan

PHOTOGRAPH, QUALITY = 720, 85
"""Pixels of the photograph's longer edge; of its JPEG."""
SWATCH = 56
"""Pixels of a material's rendered sphere."""
MOST_SWATCHES = 24
"""Materials that get one: the largest."""
BESIDE = 0.35
"""Brightness of the photograph beside what has an albedo."""
LIGHT_ROWS = 160
"""Of the panorama."""


def report(
    scan: ShownScan,
    name: str,
    photograph: Frame,
    summary: str,
    warnings: Sequence[str],
) -> bytes:
    """Write the page.

    Args:
        scan: what was scanned.
        name: of the capture.
        photograph: a frame of it; the model is first seen from its side.
        summary: what was used, in a sentence.
        warnings: sentences; those of the materials are added.

    Returns:
        The file; the same scan gives the same bytes.
    """
    shading = Shading(scan)
    azimuth, rise = _direction(scan, photograph.camera_centre)
    data = {**model_data(shading), "azimuth": azimuth, "rise": rise}
    folder = files("reflest_core.viewer.report")
    template = Template((folder / "page.html").read_text("utf-8"))
    labels, albedo = _overlays(scan, photograph)
    materials = scan.found.materials
    models = ", ".join(sorted({one.estimate.model_id for one in materials}))
    page = template.substitute(
        title=f"Materials of {html.escape(name)}",
        summary=html.escape(summary),
        photograph=_jpeg_uri(photograph.rgb),
        labels=_jpeg_uri(labels),
        albedo=_jpeg_uri(albedo),
        warnings=_warnings(scan.found, warnings),
        materials="".join(
            _row(one, scan.light if number < MOST_SWATCHES else None)
            for number, one in enumerate(materials)
        ),
        variant=", ".join(sorted({one.estimate.ward_variant for one in materials})),
        light=_panorama(scan.light),
        light_words=_light_words(scan.light),
        made_by=f"Made by reflest {__version__} with {html.escape(models)}.",
        # "</script>" in the data would end the element.
        data=json.dumps(data, allow_nan=False).replace("<", "\\u003c"),
        script=(folder / "model.js").read_text("utf-8"),
    )
    return page.encode("utf-8")


def _overlays(scan: ShownScan, photograph: Frame) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """The photograph with the ids of the materials over it, and with the albedo over it."""
    found, rgb = scan.found, photograph.rgb
    frame = photograph.relative_to(found.surface.origin)
    view = CameraView(frame.intrinsics, frame.T_world_camera)
    voxels = voxels_in_image(found.surface.positions, view, scan.voxel_size)
    known = np.flatnonzero(np.isfinite(found.rho_d).all(axis=1))
    encoded = np.full(found.rho_d.shape, -1.0)
    encoded[known] = 255.0 * srgb.encode(found.rho_d[known].astype(np.float64))
    # The row after the last voxel's stands for pixels that show none.
    of_pixels = np.append(encoded, [[-1.0] * 3], axis=0)[voxels]
    albedo = np.where(of_pixels >= 0.0, of_pixels, BESIDE * rgb)
    return labels_over(rgb, voxels, found.material_ids), np.rint(albedo).astype(np.uint8)


def _direction(scan: ShownScan, eye: NDArray[np.float64]) -> tuple[float, float]:
    """Azimuth and height over the horizon of a camera, radians."""
    middle = (scan.vertices.min(axis=0) + scan.vertices.max(axis=0)) / 2.0
    x, y, z = (rotation_to_z(scan.up) @ (eye - middle)).tolist()
    return math.atan2(y, x), math.atan2(z, math.hypot(x, y))


def _jpeg_uri(image: NDArray[np.uint8]) -> str:
    scale = min(PHOTOGRAPH / max(image.shape[:2]), 1.0)
    small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    _, content = cv2.imencode(".jpg", small[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    return f"data:image/jpeg;base64,{base64.b64encode(content.tobytes()).decode()}"


def _warnings(found: MaterialMap, others: Sequence[str]) -> str:
    """Each sentence once, with the materials that it is about."""
    about = {**{sentence: [] for sentence in others}, **found.warnings()}
    if not about:
        return "<p>None.</p>"
    lines = []
    for sentence, ids in about.items():
        which = ""
        if ids and len(found.materials) > 1:
            plural = "s" if len(ids) > 1 else ""
            which = f"<b>Material{plural} {', '.join(map(str, ids))}:</b> "
        lines.append(f"<li>{which}{html.escape(sentence)}</li>")
    return f"<ul>{''.join(lines)}</ul>"


def _row(material: MaterialEstimate, light: NDArray[np.float32] | None) -> str:
    estimate = material.estimate
    albedo = "<br>".join(
        with_deviation(value, stddev)
        for value, stddev in zip(estimate.rho_d, estimate.rho_d_stddev, strict=True)
    )
    error = material.photometric_error
    cells = (
        "" if light is None else swatch(estimate, light, SWATCH),
        f"{patch(material_colour(material.id), '1em')} {patch(colour_of(estimate.rho_d), '1em')} "
        f"{material.id}",
        f"{1e4 * material.area:.1f} cm&sup2;",
        albedo,
        with_deviation(estimate.rho_s, estimate.rho_s_stddev),
        with_deviation(estimate.alpha, estimate.alpha_stddev),
        f"{error:.0%}" if math.isfinite(error) else "",
    )
    numbers = "".join(f"<td class='number'>{cell}</td>" for cell in cells)
    status = f"<td>{WORDS[estimate.status]}</td>"
    return f"<tr data-material='{material.id}'>{numbers}{status}</tr>"


def _panorama(light: NDArray[np.float32] | None) -> str:
    seen = nothing_seen(LIGHT_ROWS)
    if light is not None:
        seen = from_octahedral(light, LIGHT_ROWS)
    return png_uri(tone_mapped(seen))


def _light_words(light: NDArray[np.float32] | None) -> str:
    if light is None:
        return "The network of these estimates sees no light: the model is drawn in a studio's."
    angles = octahedral_solid_angles(len(light))
    seen = float((light[..., 3] * angles).sum() / angles.sum())
    return (
        f"{seen:.0%} of all directions were seen; the dim rest is inferred from "
        "what the materials reflect. Up is at the top, +x in the middle, +y a quarter to the left."
    )
