# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/images/export-table.png: a photograph beside the exported scan in its own light.

``python docs/figures/exported_table.py captures/table OUT.png``, or another capture of a table.
The right half is what Mitsuba renders of ``reflest export --format mitsuba-stock``, from the camera
of the bag's first frame.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.capture.frame import Frame
from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.pipeline import EVERY_VOXEL, Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.evaluation.pictures.image_distance import image_distance
from reflest_core.export.exporter import export_scan
from reflest_core.synbrdf.path_tracing.ward_bsdf import mi

WIDTH, HEIGHT = 480, 360
SAMPLES = 128


def main() -> None:
    """Scan, export, render, draw."""
    bag, out = sys.argv[1:]
    frames = list(open_capture(bag))
    pipeline = Pipeline(ReflestSettings())
    for frame in frames:
        pipeline.fuse(frame)
    found = pipeline.materials(pipeline.snapshot(EVERY_VOXEL))
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "table.xml"
        export_scan(pipeline.scan, found, scene, "mitsuba-stock")
        rendered = _rendered(scene, frames[0])
    photograph = cv2.resize(frames[0].rgb, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
    cv2.imwrite(out, np.concatenate([photograph, rendered], axis=1)[..., ::-1])
    print(f"FLIP {image_distance(photograph / 255.0, rendered / 255.0).flip:.3f}")


def _rendered(scene: Path, frame: Frame) -> NDArray[np.uint8]:
    """(HEIGHT, WIDTH, 3) sRGB of the scene as the frame's camera sees it."""
    T, camera = frame.T_world_camera, frame.intrinsics
    view = mi.ScalarTransform4f().look_at(
        T[:3, 3].tolist(), (T[:3, 3] + T[:3, 2]).tolist(), (-T[:3, 1]).tolist()
    )
    sensor = mi.load_dict(
        {
            "type": "perspective",
            "fov": float(2 * np.degrees(np.arctan(camera.width / 2 / camera.fx))),
            "to_world": view,
            "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT},
        }
    )
    image = np.array(mi.render(mi.load_file(str(scene)), sensor=sensor, spp=SAMPLES))
    encoded = srgb.encode(np.clip(image[..., :3], 0.0, 1.0))
    return np.rint(255 * encoded).astype(np.uint8)


if __name__ == "__main__":
    main()
