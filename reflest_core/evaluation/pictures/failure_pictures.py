# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Pictures of a badly estimated scene: a view, the observed light, truth and estimate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.environment.environment_map import from_octahedral
from reflest_core.environment.picture import tone_mapped
from reflest_core.evaluation.pictures.plots import new_figure
from reflest_core.evaluation.pictures.swatches import Swatch
from reflest_core.light.completion import complete
from reflest_core.light.light_map import ObservedLight
from reflest_core.synbrdf.scenes.exposure import expose
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene

LIGHT_ROWS = 96

Picture = NDArray[np.float64]


def draw_failure(
    path: Path,
    view: Picture,
    light: ObservedLight,
    swatch: Swatch,
    truth: NDArray[np.float64],
    estimate: NDArray[np.float64],
) -> None:
    """Write a PNG of four pictures in a row.

    Args:
        path: The file to write.
        view: (H, W, 3) sRGB in [0, 1], a view of the scene.
        light: The light that was observed.
        swatch: Renders truth and estimate.
        truth: (5,) Ward parameters.
        estimate: (5,) Ward parameters.
    """
    panels = {
        "a view": view,
        "light (dim: not seen)": light_picture(light),
        "truth": swatch.picture(truth),
        "estimate": swatch.picture(estimate),
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    figure = new_figure(7.6, 1.75)
    widths = [picture.shape[1] / picture.shape[0] for picture in panels.values()]
    axes = figure.subplots(1, len(panels), width_ratios=widths)
    for panel, (title, picture) in zip(axes, panels.items(), strict=True):
        panel.imshow(np.clip(picture, 0.0, 1.0), interpolation="lanczos")
        panel.set_title(title, fontsize=8)
        panel.set_axis_off()
    figure.savefig(path, dpi=100)


def fullest_view(scene: SynbrdfScene) -> int:
    """Index of the view that shows most of the object.

    Args:
        scene: A scene of the data set.
    """
    return int(scene.thumbnails.is_object.sum(axis=(1, 2)).argmax())


def thumbnail_picture(scene: SynbrdfScene, view: int) -> Picture:
    """The thumbnail of a view with the camera's exposure.

    Args:
        scene: A scene of the data set.
        view: Index of the view.

    Returns:
        (36, 48, 3) float64 sRGB in [0, 1].
    """
    thumbnail = scene.thumbnails.of_views(np.array([view]))
    return expose(thumbnail.radiance()[0], scene.exposure) / 255.0


def light_picture(light: ObservedLight) -> Picture:
    """The completed light as a picture; what was not observed is dimmed.

    Args:
        light: The observed light.

    Returns:
        (LIGHT_ROWS, 2 LIGHT_ROWS, 3) float64 sRGB in [0, 1], equirectangular, zenith up.
    """
    return tone_mapped(from_octahedral(complete(light).levels[0], LIGHT_ROWS)) / 255.0
