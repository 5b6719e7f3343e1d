# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The scan that the node saved as a model: seen from the capture's cameras, and exported."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.frame import Frame
from reflest_core.estimation.pipeline import EVERY_VOXEL, Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.export.exporter import export_scan
from reflest_core.light.octahedral import octahedral_texels
from reflest_core.rendering.mesh_image import mesh_image, ray_directions
from reflest_core.surface.upright import rotation_to_z
from reflest_core.viewer.lights import Light
from reflest_core.viewer.report.document import report
from reflest_core.viewer.shading import Shading, displayed
from reflest_core.viewer.shown_scan import ShownScan
from reflest_core.whole_file import write_whole

SMOOTH = 0.02
"""Standard deviation of the blur of the light behind the model, over the image's width."""


class Model:
    """A saved scan with its materials.

    Attributes:
        found: the materials of all voxels.
        shown: the mesh.
    """

    def __init__(self, scan: Path) -> None:
        """Load the scan and estimate its materials.

        Args:
            scan: file that the node saved.
        """
        self._pipeline = Pipeline(ReflestSettings())
        self._pipeline.load(scan)
        self.found = self._pipeline.materials(self._pipeline.snapshot(EVERY_VOXEL))
        up = self._pipeline.settings.estimation.up
        self.shown = ShownScan.of(self._pipeline.scan, self.found, up)
        self._shading = Shading(self.shown)

    def seen_from(self, frame: Frame, width: int, light: Light) -> NDArray[np.uint8]:
        """Render the model from a frame's camera.

        Args:
            frame: of the capture.
            width: pixels of the image; its height follows the frame's proportions.
            light: what it stands in.

        Returns:
            (H, width, 3) 8-bit sRGB.
        """
        pyramid = self._shading.light(light)
        eye = frame.T_world_camera[:3, 3]
        radiance = self._shading.diffuse(pyramid) + self._shading.mirrored(pyramid, eye)
        height = round(width * frame.rgb.shape[0] / frame.rgb.shape[1])
        rays = ray_directions(frame.intrinsics, frame.T_world_camera, height, width)
        upright = rays.reshape(-1, 3) @ rotation_to_z(self.shown.up).T
        level = pyramid.levels[0]
        behind = level.reshape(-1, level.shape[-1])[octahedral_texels(upright, len(level)), :3]
        # The map's texels are some degrees wide: their edges would show.
        coarse = behind.reshape(height, width, 3)
        smooth = np.asarray(cv2.GaussianBlur(coarse, (0, 0), SMOOTH * width), np.float32)
        return mesh_image(
            self.shown.vertices,
            self.shown.faces,
            displayed(radiance),
            displayed(smooth),
            frame.intrinsics,
            frame.T_world_camera,
        )

    def export(self, path: Path) -> None:
        """Write the surface with its materials.

        Args:
            path: the file; its suffix is a format's of ``reflest export``.
        """
        export_scan(self._pipeline.scan, self.found, path)

    def write_report(self, path: Path, frame: Frame, name: str) -> None:
        """Write the page of ``reflest replay --report``.

        Args:
            path: the file.
            frame: whose image the page shows.
            name: of the capture.
        """
        scan = self._pipeline.scan
        summary = f"{scan.voxel_count:,} voxels, {scan.view_count} views"
        write_whole(path, report(self.shown, name, frame, summary, []))
