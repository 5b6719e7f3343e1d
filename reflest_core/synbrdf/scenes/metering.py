# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a camera exposes a scene for; a rendered scene can be exposed again without rendering."""

from __future__ import annotations

import dataclasses
import enum

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.realism.view_images import with_gains
from reflest_core.synbrdf.scenes.exposure import auto_exposure, expose
from reflest_core.synbrdf.scenes.scene_file import SynbrdfScene
from reflest_core.synbrdf.scenes.thumbnails import Thumbnails


class Metering(enum.Enum):
    """Which pixels decide the exposure that all views of a scene share."""

    FRAME = "frame"
    """All. The object is a small part of them, and clips where the room about it is dark."""
    OBJECT = "object"
    """The object's, as for somebody who taps on what is scanned, or locks exposure on it."""


def remetered(scene: SynbrdfScene, metering: Metering) -> SynbrdfScene:
    """Expose a scene as a camera of another metering would have: colours, F, B, exposure.

    Args:
        scene: the scene.
        metering: what the camera exposes for; ``FRAME`` is how scenes are rendered.
    """
    if metering is Metering.FRAME:
        return scene
    exposure = object_exposure(scene.thumbnails)
    views = len(scene.thumbnails.rgbe)
    images = with_gains(scene.thumbnails, exposure, np.ones((views, 3), np.float32))
    surface = dataclasses.replace(
        scene.surface,
        colours=expose(scene.radiance.astype(np.float32), exposure),
        view_foreground=images.foreground,
        view_background=images.background,
    )
    return dataclasses.replace(scene, surface=surface, exposure=exposure)


def object_exposure(thumbnails: Thumbnails) -> float:
    """:func:`.auto_exposure` of the object's pixels in all views together.

    Args:
        thumbnails: small images of all views.
    """
    return auto_exposure(thumbnails.radiance()[thumbnails.is_object])


def mean_colours(
    images: NDArray[np.uint8], is_foreground: NDArray[np.bool_]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """F and B (W, 3), mean 8-bit colour of (W, P, 3) images; NaN where there is no such pixel.

    Args:
        images: (W, P, 3) 8-bit.
        is_foreground: (W, P) bool.
    """
    with np.errstate(invalid="ignore"):
        means = [
            np.where(part[..., None], images, 0).sum(axis=1) / part.sum(axis=1)[:, None]
            for part in (is_foreground, ~is_foreground)
        ]
    return means[0].astype(np.float32), means[1].astype(np.float32)
