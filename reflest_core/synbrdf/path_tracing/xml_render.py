# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Rendering a Mitsuba file that may use the plugin ``reflest_ward``.

Importing this module loads Mitsuba.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.errors import ReflestError
from reflest_core.synbrdf.path_tracing.ward_bsdf import mi


class SceneUnreadable(ReflestError):
    """A Mitsuba file cannot be rendered."""


def render_xml(
    path: Path, sensor: int = 0, samples: int | None = None, seed: int = 0
) -> NDArray[np.float32]:
    """Render one of a file's sensors.

    Args:
        path: the file.
        sensor: index of the camera.
        samples: paths of a pixel; None keeps the file's.
        seed: of the random numbers.

    Returns:
        (H, W, 3) linear sRGB radiance.
    """
    if not path.is_file():
        raise SceneUnreadable(f"there is no Mitsuba scene at {path}")
    try:
        scene = mi.load_file(str(path))
    except (RuntimeError, ValueError) as error:
        raise SceneUnreadable(f"{path} cannot be loaded: {str(error).splitlines()[0]}") from error
    sensors = scene.sensors()
    if not 0 <= sensor < len(sensors):
        raise SceneUnreadable(
            f"{path} has {len(sensors)} sensors: --sensor must be 0 to {len(sensors) - 1}"
        )
    image = mi.render(scene, sensor=sensors[sensor], spp=samples or 0, seed=seed)
    return np.array(image, dtype=np.float32)[..., :3]
