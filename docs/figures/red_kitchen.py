# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The tables and pictures of docs/results/red-kitchen.md: things of a real room, estimated.

python docs/figures/red_kitchen.py REDKITCHEN docs/results
"""

import argparse
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.capture.frame import Frame
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import FrameRefused
from reflest_core.environment.completed_light import completed_light
from reflest_core.estimation.estimate import BrdfEstimate, EstimateStatus
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.inference.transport.irradiance import mean_radiance
from reflest_core.inference.transport.ward_lobe import ROUGHNESSES, lobe_radiance
from reflest_core.light.completion import levels_below
from reflest_core.surface.observed_surface import ObservedSurface

UP = (0.02, -0.89, -0.455)
"""In the data set's world: the normal of the table, and of the worktop."""
MODELS = ("lightnet", "grouplet-slow", "hemicnn")
MARGIN = 40
"""Pixels of the photograph shown around a thing."""

Points = NDArray[np.float64]


@dataclass(frozen=True)
class Thing:
    """A thing in the room: the region that holds it, and the name of its picture."""

    name: str
    picture: str
    region: RegionSettings


@dataclass(frozen=True)
class Scanned:
    """A thing's surface, the frame that saw most of it, and the estimate of every model."""

    surface: ObservedSurface
    frame: Frame
    estimates: dict[str, BrdfEstimate]


def ball(x: float, y: float, z: float, radius: float) -> RegionSettings:
    """A sphere in the data set's world, metres."""
    return RegionSettings("sphere", (x, y, z), (2 * radius,) * 3)


DOORS = RegionSettings("box", (-1.91, 0.125, 1.95), (0.22, 0.35, 0.9))
THINGS = (
    Thing("glossy red doors", "doors", DOORS),
    Thing("dark worktop", "worktop", ball(-1.894, -0.02, 1.36, 0.08)),
    Thing("wooden table", "table", ball(0.33, 0.07, 1.667, 0.12)),
    Thing("white mug", "mug", ball(-0.76, -0.185, 1.925, 0.07)),
    Thing("red game pad", "pad", ball(0.77, -0.03, 1.565, 0.10)),
)


def scan(folder: Path, region: RegionSettings) -> Scanned:
    """Replay the capture as ``reflest replay`` does, and estimate with every model at its end."""
    settings = ReflestSettings(region=region, fusion=FusionSettings(max_depth=4.0))
    pipeline, capture = Pipeline(settings), open_capture(folder)
    fullest, most = None, -1
    for frame in capture:
        try:
            seen = pipeline.fuse(frame).fused.voxels_seen
        except FrameRefused as refusal:
            capture.refuse(refusal)
            continue
        if seen > most:
            fullest, most = frame, seen
    assert fullest is not None, f"no frame of {folder} shows the region"
    surface = pipeline.snapshot().surface
    estimates = {
        model: Estimator(EstimationSettings(model, up=UP)).estimate(surface, 0, "")
        for model in MODELS
    }
    return Scanned(surface, fullest, estimates)


def rendered(scanned: Scanned, estimate: BrdfEstimate) -> Points:
    """(V, 3) sRGB of every voxel as the frame's camera would see the estimate there."""
    surface = scanned.surface
    light = levels_below(completed_light(surface))
    towards = scanned.frame.T_world_camera[:3, 3] - surface.positions
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    lobes = lobe_radiance(light, surface.normals, towards.astype(np.float32))[..., :3]
    nearest = int(np.abs(np.array(ROUGHNESSES) - estimate.alpha).argmin())
    diffuse = mean_radiance(light, surface.normals)[:, :3] * np.array(estimate.rho_d)
    radiance = diffuse + estimate.rho_s * lobes[:, nearest]
    return srgb.encode(np.clip(radiance, 0.0, 1.0).astype(np.float64))


def observed(surface: ObservedSurface) -> Points:
    """(V, 3) sRGB: the mean of what was observed of every voxel, at the scan's exposure."""
    counts = np.maximum(surface.observation_counts, 1)[:, None]
    sums = np.add.reduceat(
        np.vstack([srgb.decode(surface.colours / 255.0), np.zeros((1, 3))]), surface.offsets[:-1]
    )
    return srgb.encode(np.where(surface.observation_counts[:, None] > 0, sums / counts, 0.0))


def draw(path: Path, scanned: Scanned) -> None:
    """The photograph, what was observed, and the estimate rendered in the light that was seen."""
    frame, surface = scanned.frame, scanned.surface
    camera = frame.intrinsics
    in_camera = (surface.positions - frame.T_world_camera[:3, 3]) @ frame.T_world_camera[:3, :3]
    u = in_camera[:, 0] * camera.fx / in_camera[:, 2] + camera.cx
    v = in_camera[:, 1] * camera.fy / in_camera[:, 2] + camera.cy
    faces = ((surface.positions - frame.T_world_camera[:3, 3]) * surface.normals).sum(axis=1) < 0
    shown = faces & (surface.observation_counts > 0) & (in_camera[:, 2] > 0)
    order = np.nonzero(shown)[0][np.argsort(-in_camera[shown, 2])]
    left, right = np.clip([u[order].min() - MARGIN, u[order].max() + MARGIN], 0, camera.width)
    top, bottom = np.clip([v[order].min() - MARGIN, v[order].max() + MARGIN], 0, camera.height)
    height = max(8.4 / 3 * (bottom - top) / (right - left), 1.6) + 0.3
    figure, axes = plt.subplots(1, 3, figsize=(8.4, height))
    panels = {
        "photograph": None,
        "observed (mean of all views)": observed(surface),
        "lightnet's estimate, in the light seen": rendered(scanned, scanned.estimates["lightnet"]),
    }
    width = 72.0 * 2.8 / (right - left) * 0.005 * camera.fx / np.median(in_camera[order, 2])
    for panel, (title, colours) in zip(axes, panels.items(), strict=True):
        panel.imshow(frame.rgb if colours is None else np.zeros_like(frame.rgb))
        if colours is not None:
            panel.scatter(u[order], v[order], s=(1.5 * width) ** 2, c=colours[order], lw=0)
        panel.set_xlim(left, right)
        panel.set_ylim(bottom, top)
        panel.set_title(title, fontsize=8)
        panel.set_axis_off()
    figure.tight_layout(pad=0.3)
    figure.savefig(path, dpi=110, bbox_inches="tight")
    plt.close(figure)


def row(thing: Thing, model: str, estimate: BrdfEstimate) -> str:
    """One line of the table; deviations only where the model knows them."""
    values = [
        _value(value, deviation)
        for value, deviation in (
            *zip(estimate.rho_d, estimate.rho_d_stddev, strict=True),
            (estimate.rho_s, estimate.rho_s_stddev),
            (estimate.alpha, estimate.alpha_stddev),
        )
    ]
    cells = [
        thing.name,
        model,
        str(estimate.view_count),
        f"{estimate.coverage:.0%}",
        *values,
        EstimateStatus(estimate.status).name,
    ]
    return f"| {' | '.join(cells)} |"


def _value(value: float, deviation: float) -> str:
    return f"{value:.3f}" if np.isnan(deviation) else f"{value:.3f} ± {deviation:.3f}"


def main() -> None:
    """Write the pictures and print the table."""
    parser = argparse.ArgumentParser(description="Things in 7-Scenes' red kitchen.")
    parser.add_argument("capture", type=Path, help="the folder of frames")
    parser.add_argument("out", type=Path)
    arguments = parser.parse_args()
    print("| thing | model | views | coverage | red | green | blue | rho_s | alpha | status |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for thing in THINGS:
        scanned = scan(arguments.capture, thing.region)
        for model, estimate in scanned.estimates.items():
            print(row(thing, model, estimate), flush=True)
        draw(arguments.out / f"red-kitchen-{thing.picture}.png", scanned)
        light = scanned.surface.light
        share = light.seen_share if light is not None else 0.0
        print(f"<!-- {thing.name}: {share:.0%} of the light seen -->")


if __name__ == "__main__":
    main()
