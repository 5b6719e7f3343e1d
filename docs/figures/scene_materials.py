# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Draw what was found of whole scenes beside photograph and truth.

python docs/figures/scene_materials.py SCENE [SCENE...] --out docs/images/scene-materials.jpg

SCENE is a bag of ``reflest synbrdf tabletop`` with its truth.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib import colormaps
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from reflest_core.brdf import srgb
from reflest_core.capture.frame import Frame
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import FrameRefused
from reflest_core.estimation.material_map import MaterialMap
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.evaluation.statistics.material_clouds import read_cloud
from reflest_core.inference.transport.surface_irradiance import SurfaceSight, surface_irradiance
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES, lobe_radiance
from reflest_core.light.completion import RADIANCE
from reflest_core.rendering.material_labels import CameraView, labels_over, voxels_in_image

LARGEST_ALPHA = 0.3
"""Roughness of the brightest colour."""
NEAR = 0.01
"""Metres from a voxel to its true point."""
EMPTY = 0.12
"""Grey of what has no value."""

Colours = NDArray[np.float64]


def scan(folder: Path) -> tuple[MaterialMap, Frame, float]:
    """Replay a scene: its materials, the frame that saw most of it, and the size of a voxel."""
    pipeline, capture = Pipeline(ReflestSettings()), open_capture(folder)
    fullest, most = None, -1
    for frame in capture:
        try:
            seen = pipeline.fuse(frame).fused.voxels_seen
        except FrameRefused as refusal:
            capture.refuse(refusal)
            continue
        if seen > most:
            fullest, most = frame, seen
    assert fullest is not None, f"no frame of {folder} was fused"
    return pipeline.final_materials(), fullest, pipeline.settings.fusion.voxel_size


def of_voxels(found: MaterialMap, parameter: str) -> Colours:
    """(V,) a material's value at each of its voxels, NaN where there is none."""
    values = {one.id: getattr(one.estimate, parameter) for one in found.materials}
    return np.array([values.get(int(one), np.nan) for one in found.material_ids])


def rendered(found: MaterialMap, frame: Frame) -> Colours:
    """(V, 3) sRGB of each voxel in the estimated light, as the frame's camera sees it."""
    surface, light = found.surface, found.light
    assert light is not None
    sight = SurfaceSight.of(surface.positions, surface.normals, light.occluders)
    diffuse = surface_irradiance(light.completed, sight)[:, RADIANCE] * found.rho_d
    towards = frame.T_world_camera[:3, 3] - surface.world_positions
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    lobes = lobe_radiance(light.completed, surface.normals, towards.astype(np.float32))
    alpha = np.nan_to_num(of_voxels(found, "alpha"), nan=0.1)
    nearest = np.abs(np.log(np.array(ROUGHNESSES) / alpha[:, None])).argmin(axis=1)
    gloss = lobes[np.arange(len(nearest)), nearest, :3] * of_voxels(found, "rho_s")[:, None]
    return srgb.encode(np.clip(diffuse + gloss, 0.0, 1.0).astype(np.float64))


def rough(alpha: Colours) -> Colours:
    """(V, 3) colours of roughnesses; NaN stays NaN."""
    colours = colormaps["viridis"](np.clip(np.nan_to_num(alpha) / LARGEST_ALPHA, 0.0, 1.0))[:, :3]
    return np.where(np.isnan(alpha)[:, None], np.nan, colours)


def panels(folder: Path) -> dict[str, Colours]:
    """The pictures of one scene by title, sRGB."""
    found, frame, voxel_size = scan(folder)
    view = CameraView(frame.intrinsics, frame.T_world_camera)
    voxels = voxels_in_image(found.surface.world_positions, view, voxel_size)
    truth = read_cloud(folder / "truth.ply")
    places = np.stack([truth[axis] for axis in "xyz"], axis=1)
    distance, nearest = cKDTree(places).query(found.surface.world_positions)
    true_albedo = np.stack([truth[f"rho_d_{channel}"][nearest] for channel in "rgb"], axis=1)
    is_far = distance > NEAR

    def image(colours: Colours) -> Colours:
        filled = np.where(np.isnan(colours), EMPTY, colours)
        return np.append(filled, np.full((1, 3), EMPTY), axis=0)[voxels]

    return {
        "photograph": frame.rgb / 255.0,
        "estimate in its light": image(rendered(found, frame)),
        "materials": labels_over(frame.rgb, voxels, found.material_ids) / 255.0,
        "albedo": image(srgb.encode(np.clip(found.rho_d, 0.0, 1.0).astype(np.float64))),
        "true albedo": image(
            srgb.encode(np.where(is_far[:, None], np.nan, true_albedo).astype(np.float64))
        ),
        f"roughness, 0 to {LARGEST_ALPHA}": image(rough(of_voxels(found, "alpha"))),
        "true roughness": image(rough(np.where(is_far, np.nan, truth["alpha"][nearest]))),
    }


def main() -> None:
    """Draw a row for each scene."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", type=Path, nargs="+")
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    rows = [panels(scene) for scene in arguments.scenes]
    height, width = rows[0]["photograph"].shape[:2]
    across = 2.0
    size = (across * len(rows[0]), across * height / width * len(rows) + 0.25)
    figure, axes = plt.subplots(len(rows), len(rows[0]), figsize=size, squeeze=False)
    for of_row, pictures in zip(axes, rows, strict=True):
        for axis, picture in zip(of_row, pictures.values(), strict=True):
            axis.imshow(picture)
            axis.axis("off")
    for axis, title in zip(axes[0], rows[0], strict=True):
        axis.set_title(title, fontsize=8, pad=3)
    figure.subplots_adjust(0, 0, 1, 1 - 0.2 / size[1], 0.02, 0.02)
    figure.savefig(arguments.out, dpi=130, pil_kwargs={"quality": 88})


if __name__ == "__main__":
    main()
