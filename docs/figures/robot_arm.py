# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The pictures and the table of docs/results/robot-arm.md: a shelf and a bin, seen by a robot arm.

python docs/figures/robot_arm.py RGBD_FOLDER docs/results
"""

import argparse
from pathlib import Path

import cv2
import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.capture.folders.files import depth_message
from reflest_core.capture.frame import Frame
from reflest_core.capture.images.decode import decode_depth
from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.material_map import MaterialMap
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings

CAPTURES = {"shelf_label_fusion": "shelf", "bin_apc": "bin"}
SHOWN = 2
"""The frame that is shown."""
POINT = 3
"""Edge of a voxel in the picture, pixels."""


def projected(
    colours: NDArray[np.float32], found: MaterialMap, frame: Frame
) -> NDArray[np.float32]:
    """Draw voxels into a frame, the nearest in front; grey where there is none."""
    T = np.linalg.inv(frame.T_world_camera)
    points = found.surface.positions @ T[:3, :3].T + T[:3, 3]
    camera = frame.intrinsics
    picture = np.full((camera.height, camera.width, 3), 0.5, np.float32)
    ahead = points[:, 2] > 0.05
    for index in np.argsort(-points[:, 2]):
        if not ahead[index] or np.isnan(colours[index]).any():
            continue
        x, y, z = points[index]
        column, row = round(camera.fx * x / z + camera.cx), round(camera.fy * y / z + camera.cy)
        if 0 <= column < camera.width and 0 <= row < camera.height:
            picture[row - POINT : row + POINT + 1, column - POINT : column + POINT + 1] = colours[
                index
            ]
    return picture


def measured(folder: Path) -> NDArray[np.bool_]:
    """Where the shown frame's depth map is valid, before its gaps are filled."""
    path = folder / f"frame-{SHOWN:06d}.depth.png"
    return decode_depth(depth_message(path, 0), str(path), 1e-4, is_rotated=True) > 0.0


def main() -> None:
    """Write the two pictures, and print the table's rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("captures", type=Path)
    parser.add_argument("out", type=Path)
    options = parser.parse_args()
    for name, picture in CAPTURES.items():
        capture = open_capture(options.captures / name)
        pipeline = Pipeline(ReflestSettings(estimation=EstimationSettings(up=(0.0, 0.0, 1.0))))
        frames = list(capture)
        for frame in frames:
            pipeline.fuse(frame)
        found, shown = pipeline.final_materials(), frames[SHOWN]
        agreement = pipeline.poses.report.agreement
        print(f"{picture}: {len(frames)} frames, agreement {agreement:.2f}")
        for material in found.materials[:6]:
            one = material.estimate
            rho_d = " ".join(f"{value:.3f}" for value in one.rho_d)
            print(
                f"| {picture} | {material.id} | {material.area * 1e4:.0f} | {rho_d} | "
                f"{one.rho_s:.3f} ± {one.rho_s_stddev:.3f} | {one.alpha:.2f} ± "
                f"{one.alpha_stddev:.2f} | {one.status.name} |"
            )
        albedo = srgb.encode(np.clip(projected(found.rho_d, found, shown), 0.0, 1.0))
        panels = {
            "photograph": shown.rgb,
            "depth as recorded": measured(options.captures / name),
            "depth with gaps filled": shown.depth > 0.0,
            "diffuse albedo": albedo,
        }
        figure, axes = plt.subplots(1, 4, figsize=(14, 3))
        for axis, (title, pixels) in zip(axes, panels.items(), strict=True):
            axis.imshow(np.asarray(pixels), cmap="gray")
            axis.set_title(title)
            axis.axis("off")
        figure.tight_layout()
        path = options.out / f"robot-arm-{picture}.png"
        figure.savefig(path, dpi=80)
        whole = cv2.imread(str(path))
        cv2.imwrite(str(path), whole, [cv2.IMWRITE_PNG_COMPRESSION, 9])


if __name__ == "__main__":
    main()
