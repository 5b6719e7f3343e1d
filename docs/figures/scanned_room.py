# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Draws what came out of a capture without a region: photographs, materials, albedos, rendering.

``python docs/figures/scanned_room.py CAPTURE OUT.png --frames 10 60 --up 0 0 1 --at NAME X Y Z``;
every ``--at`` prints the material at a point of the world, ``--largest 6`` the six largest.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import FrameRefused
from reflest_core.estimation.material_map import MaterialEstimate, nearest_material
from reflest_core.estimation.pipeline import EVERY_VOXEL, Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.fusion.settings import FusionSettings
from reflest_core.rendering.mesh_image import mesh_image
from reflest_core.viewer.colour_modes import ColourMode, coloured
from reflest_core.viewer.lights import Light
from reflest_core.viewer.shading import Shading, displayed
from reflest_core.viewer.shown_scan import ShownScan

WIDTH, GAP = 400, 6
BEHIND = 235
"""Grey of what was not scanned."""
FACES = 300_000


def main() -> None:
    """Scan, estimate, draw and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("capture", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--frames", type=int, nargs="+", default=[0])
    parser.add_argument("--up", type=float, nargs=3, default=(0.0, 0.0, 1.0))
    parser.add_argument("--max-depth", type=float, default=4.0)
    parser.add_argument("--at", nargs=4, action="append", default=[], metavar="NAME X Y Z")
    parser.add_argument("--largest", type=int, default=0)
    options = parser.parse_args()
    settings = ReflestSettings(
        fusion=FusionSettings(max_depth=options.max_depth),
        estimation=EstimationSettings(up=tuple(options.up)),
    )
    pipeline, capture, drawn = Pipeline(settings), open_capture(options.capture), []
    for index, frame in enumerate(capture):
        try:
            view = pipeline.fuse(frame).fused.view
            if index in options.frames:
                drawn.append((frame, view))
        except FrameRefused as refusal:
            capture.refuse(refusal)
    found = pipeline.materials(pipeline.snapshot(EVERY_VOXEL))
    print(f"{len(found.materials)} materials of {found.surface.voxel_count:,} voxels")
    by_id = {material.id: material for material in found.materials}
    ids = np.where(np.isin(found.material_ids, list(by_id)), found.material_ids, 0)
    for name, *point in options.at:
        place = np.array(point, np.float64)
        print(described(name, by_id[nearest_material(found.surface.positions, ids, place)]))
    for material in found.materials[: options.largest]:
        print(described(f"id {material.id}", material))
    shown = ShownScan.of(pipeline.scan, found, tuple(options.up), FACES)
    shading = Shading(shown)
    light = shading.light(Light.ESTIMATED)
    diffuse = shading.diffuse(light)
    rows = []
    for frame, view in drawn:
        mirrored = shading.mirrored(light, frame.T_world_camera[:3, 3])
        # At the photograph's exposure: the camera changed it from frame to frame.
        gain = float(pipeline.scan.views.gains[view])
        rendered = displayed(diffuse + mirrored, -math.log2(gain))
        modes = [coloured(shown, mode).colours for mode in (ColourMode.MATERIAL, ColourMode.ALBEDO)]
        rows.append(row(shown, frame, [*modes, rendered]))
    cv2.imwrite(str(options.out), np.concatenate(rows, axis=0)[..., ::-1])


def described(name: str, material: MaterialEstimate) -> str:
    """A row of a table: name, square centimetres, Ward values with deviations, status."""
    found = material.estimate
    values = (
        *zip(found.rho_d, found.rho_d_stddev, strict=True),
        (found.rho_s, found.rho_s_stddev),
        (found.alpha, found.alpha_stddev),
    )
    cells = [f"{value:.3f} ± {stddev:.3f}" for value, stddev in values]
    return f"| {name} | {1e4 * material.area:.0f} | {' | '.join(cells)} | {found.status.name} |"


def row(shown: ShownScan, frame: Frame, colours: list[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """The photograph, then the mesh from the same camera in each of the colourings."""
    height = round(WIDTH * frame.rgb.shape[0] / frame.rgb.shape[1])
    images = [cv2.resize(frame.rgb, (WIDTH, height), interpolation=cv2.INTER_AREA)]
    behind = np.full((height, WIDTH, 3), BEHIND, np.uint8)
    for one in colours:
        camera = frame.intrinsics, frame.T_world_camera
        images.append(mesh_image(shown.vertices, shown.faces, one, behind, *camera))
    padded = [np.pad(one, ((0, GAP), (0, GAP), (0, 0)), constant_values=255) for one in images]
    return np.concatenate(padded, axis=1)


if __name__ == "__main__":
    main()
