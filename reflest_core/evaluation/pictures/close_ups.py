# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A view of a SynBRDF scene rendered from nearby, so that the object fills the picture.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.camera import CameraIntrinsics
from reflest_core.evaluation.source_scenes import SourceScenes
from reflest_core.synbrdf.path_tracing.full_image import FullImageRenderer
from reflest_core.synbrdf.path_tracing.scene_images import SceneImages
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.synbrdf.scenes.thumbnails import THUMBNAIL

WIDTH, HEIGHT = 200, 150
SAMPLES = 64
MARGIN = 1.5
"""Width of the picture in widths of the object."""


class CloseUps:
    """Renders scenes of a data set with the sources that it was generated from.

    Attributes:
        sources: The scenes before rendering.
        images: The renderer of whole images.
    """

    def __init__(self, data: Path, environments: Path | None, meshes: Path | None) -> None:
        """Find the sources.

        Args:
            data: folder of the data set.
            environments: the folder that it was generated from; None for procedural skies.
            meshes: the folder that it was generated from; None for procedural shapes.
        """
        self.sources = SourceScenes(data, environments, meshes)
        self.images = SceneImages(self.sources.generation, WIDTH, HEIGHT, SAMPLES)

    def picture(self, scene: SynbrdfScene, view: int) -> NDArray[np.float64]:
        """Render the object in one view, with the camera's exposure.

        Args:
            scene: A scene of the data set.
            view: Index of the view.

        Returns:
            (HEIGHT, WIDTH, 3) float64 sRGB in [0, 1].
        """
        drawn = self.sources.drawn(scene)
        renderer = FullImageRenderer(close_up(scene.thumbnails.is_object[view]), SAMPLES)
        image = renderer.render(
            self.images.overview(drawn).rendered,
            drawn.light.radiance,
            drawn.poses[view],
            scene.index,
            drawn.room,
        )
        return expose(image.radiance, scene.exposure) / 255.0


def close_up(is_object: NDArray[np.bool_]) -> CameraIntrinsics:
    """A camera at a thumbnail's pose whose picture the object nearly fills.

    Args:
        is_object: (36, 48) bool, the thumbnail's pixels of the object.
    """
    if not is_object.any():
        is_object = np.ones_like(is_object)
    rows, columns = (np.flatnonzero(is_object.any(axis=axis)) for axis in (1, 0))
    left, right = float(columns[0]), float(columns[-1] + 1)
    top, bottom = float(rows[0]), float(rows[-1] + 1)
    width = min(MARGIN * max(right - left, (bottom - top) * WIDTH / HEIGHT), THUMBNAIL.width)
    scale = WIDTH / width
    corner = np.array([0.5 * (left + right - width), 0.5 * (top + bottom - HEIGHT / scale)])
    # Pixel centres lie at whole numbers; edges of the picture half a pixel before them.
    cx, cy = (np.array([THUMBNAIL.cx, THUMBNAIL.cy]) + 0.5 - corner) * scale - 0.5
    return CameraIntrinsics(
        WIDTH, HEIGHT, THUMBNAIL.fx * scale, THUMBNAIL.fy * scale, float(cx), float(cy)
    )
