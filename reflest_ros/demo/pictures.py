# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``python -m reflest_ros.demo.pictures``: the pictures of the views in ``docs/images``.

They are rendered from the very messages that the node publishes, without RViz or Foxglove.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reflest_core.brdf.srgb import encode
from reflest_core.capture.open_capture import open_capture
from reflest_core.environment.environment_map import environment_map
from reflest_core.environment.picture import coverage_codes, tone_mapped
from reflest_core.errors import ReflestError
from reflest_core.estimation.estimate import BrdfEstimate
from reflest_core.estimation.pipeline import KeyframeSnapshot, Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.fusion.settings import RegionSettings
from reflest_core.rendering.voxel_colours import VoxelColouring
from reflest_ros.demo.shipped_capture import find_capture
from reflest_ros.demo.view_scene import (
    BACKGROUND,
    Viewpoint,
    draw_cloud,
    draw_markers,
    prepare,
)
from reflest_ros.outputs.markers import marker_message
from reflest_ros.outputs.preview import preview_message
from reflest_ros.outputs.view_settings import MarkerSettings, VoxelSettings
from reflest_ros.outputs.voxel_cloud import cloud_message

DPI = 100
FAINT = "#c8c8c8"
CAPTIONS = {
    VoxelColouring.OBSERVED: "observed: mean of what the views saw",
    VoxelColouring.VIEWS: "views: how many saw the voxel, dark to light",
    VoxelColouring.ESTIMATE: "estimate: the material, lit from the keyframe",
}


def main(arguments: list[str] | None = None) -> int:
    """Scan the capture offline and draw; 2 with one sentence for a user's mistake.

    Args:
        arguments: the words of the command; None takes those of the process.
    """
    parser = argparse.ArgumentParser(prog="reflest pictures", description=__doc__)
    parser.add_argument("--capture", type=Path, help="bag folder with truth.json")
    parser.add_argument("--output", type=Path, default=Path("docs/images"))
    options = parser.parse_args(arguments)
    try:
        _draw_all(find_capture(options.capture).bag, options.output)
    except ReflestError as error:
        print(f"reflest: error: {error}", file=sys.stderr)
        return 2
    return 0


def _draw_all(bag: Path, folder: Path) -> None:
    settings = ReflestSettings()
    scanner = Pipeline(settings)
    keyframes = [scanner.fuse(frame).keyframe for frame in open_capture(bag)]
    poses = [one.T_world_camera for one in keyframes if one and one.T_world_camera is not None]
    snapshot = scanner.snapshot()
    estimate = scanner.estimate(snapshot)
    folder.mkdir(parents=True, exist_ok=True)
    for name, figure in {
        "view-preview": preview_picture(estimate),
        "view-voxels": voxel_picture(snapshot, estimate, settings),
        "view-environment": environment_picture(snapshot),
        "view-markers": marker_picture(snapshot, estimate, poses, settings),
    }.items():
        figure.savefig(folder / f"{name}.png", facecolor=BACKGROUND)
        print(f"wrote {folder / name}.png")


def preview_picture(estimate: BrdfEstimate) -> Figure:
    """The image of ``reflectance/preview``, pixel for pixel.

    Args:
        estimate: the keyframe's estimate.
    """
    message = preview_message(estimate, 256)
    picture = np.frombuffer(message.data, np.uint8).reshape(message.height, message.width, 3)
    figure = Figure(figsize=(message.width / DPI, message.height / DPI), dpi=DPI)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.imshow(picture, interpolation="none")
    axes.set_axis_off()
    return figure


def voxel_picture(
    snapshot: KeyframeSnapshot, estimate: BrdfEstimate, settings: ReflestSettings
) -> Figure:
    """The cloud of ``reflectance/voxels`` in its three colourings.

    Args:
        snapshot: the scan at a keyframe.
        estimate: the keyframe's estimate.
        settings: the parameters.
    """
    figure = Figure(figsize=(12, 4.2), dpi=DPI)
    viewpoint = _beside_camera(snapshot, 0.28)
    for place, (colouring, caption) in enumerate(CAPTIONS.items()):
        axes = figure.add_axes((place / 3 + 0.002, 0, 1 / 3 - 0.004, 0.92))
        prepare(axes, viewpoint, 0.92 * 4.2 / 4)
        cloud = cloud_message(
            snapshot,
            estimate,
            VoxelSettings(colour=colouring.value),
            settings.fusion.observations_per_voxel,
        )
        draw_cloud(axes, cloud, viewpoint, 1.5 * settings.fusion.voxel_size)
        figure.text((place + 0.5) / 3, 0.955, caption, color=FAINT, ha="center", va="center")
    return figure


def environment_picture(snapshot: KeyframeSnapshot) -> Figure:
    """Of ``reflectance/environment``: preview, coverage and the radiance itself, as the camera.

    Args:
        snapshot: the scan at a keyframe.
    """
    environment = environment_map(snapshot.surface)
    panels = {
        "preview: dim where it was not seen": tone_mapped(environment),
        "coverage: black where it is completed": coverage_codes(environment),
        "radiance, as .hdr and .exr hold it": encode(environment.radiance),
    }
    figure = Figure(figsize=(12, 2.4), dpi=DPI)
    for place, (caption, picture) in enumerate(panels.items()):
        axes = figure.add_axes((0.03 + place * 0.328, 0.12, 0.3, 0.76))
        axes.imshow(picture, cmap="gray", extent=(0, 1, 0, 1), aspect="auto")
        axes.set_xticks((0, 0.25, 0.5, 0.75, 1), ("-x", "+y", "+x", "-y", "-x"))
        axes.set_yticks((0, 0.5, 1), ("-z", "", "+z"))
        axes.tick_params(colors=FAINT)
        axes.set_title(caption, color=FAINT, fontsize=10)
    return figure


def marker_picture(
    snapshot: KeyframeSnapshot,
    estimate: BrdfEstimate,
    poses: list[NDArray[np.float64]],
    settings: ReflestSettings,
) -> Figure:
    """The markers of ``reflectance/markers`` around the cloud.

    Args:
        snapshot: the scan at a keyframe.
        estimate: the keyframe's estimate.
        poses: camera poses, (4, 4) each.
        settings: the parameters.
    """
    figure = Figure(figsize=(10, 5), dpi=DPI)
    axes = figure.add_axes((0, 0, 1, 1))
    viewpoint = Viewpoint(np.array([0.9, -2.2, 1.2]), np.array([0.0, 0.0, 0.25]), 1.4)
    prepare(axes, viewpoint, 0.5)
    cloud = cloud_message(
        snapshot, estimate, VoxelSettings(), settings.fusion.observations_per_voxel
    )
    draw_cloud(axes, cloud, viewpoint, 1.5 * settings.fusion.voxel_size)
    up = np.array(settings.estimation.up)
    markers = marker_message(snapshot, estimate, poses, MarkerSettings(), RegionSettings(), up)
    draw_markers(axes, markers, viewpoint)
    return figure


def _beside_camera(snapshot: KeyframeSnapshot, width: float) -> Viewpoint:
    """A little beside the keyframe's camera, looking at the middle of the surface."""
    positions = snapshot.surface.positions.astype(np.float64)
    target = (positions.min(axis=0) + positions.max(axis=0)) / 2
    camera = target + np.array([0.4, 0.3, 0.2])
    if snapshot.T_world_camera is not None:
        camera = snapshot.T_world_camera[:3, 3]
    aside = np.cross(camera - target, [0.0, 0.0, 1.0])
    return Viewpoint(camera + 0.25 * aside, target, width)


if __name__ == "__main__":
    sys.exit(main())
