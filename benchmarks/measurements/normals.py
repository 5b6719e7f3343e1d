# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Errors of fused normals by curvature and noise, beside Open3D's on the same frames.

``python -m benchmarks.measurements.normals`` writes ``docs/results/normals.json`` and ``.md``.
"""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.measuring.machine import ROOT
from benchmarks.scene.spheres import RADII, Noise, rim_distance, sphere_frames, surface_of
from reflest_core.capture.frame import Frame
from reflest_core.export.libraries import open3d
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.fusion.snapshot import observed_surface
from reflest_core.inference.gloss.normal_quality import normal_deviations
from reflest_core.whole_file import write_whole

FRAMES = 48
NOISES = (
    Noise("none", 0.0),
    Noise("independent", 1.0),
    Noise("correlated", 1.0, is_correlated=True),
)
SMOOTHING = 25.0
"""``fusion.normal_smoothing`` of the smoothed normals, degrees."""
RIM = 0.015
"""Metres: nearer to where two surfaces meet a voxel has no curvature of its own."""
LEAST_FRAMES = 3.0
"""A point is compared if so many frames saw it."""
SHARES = (0.5, 0.9)
"""Quantiles that are published."""


def measure(frames: int = FRAMES) -> dict[str, Any]:
    """Measure all noises.

    Args:
        frames: Frames of a scan.

    Returns:
        By noise and surface (radius in metres, "flat"): quantiles of the errors in degrees of both
        methods, how many points they are of, and how the stated deviations compare.
    """
    return {noise.name: _of_noise(noise, frames) for noise in NOISES}


def _of_noise(noise: Noise, count: int) -> dict[str, Any]:
    frames = list(sphere_frames(count, noise))
    settings = FusionSettings()
    scan = Scan(settings, RegionSettings("box", (0.0, 0.0, 0.1), (1.2, 1.2, 0.6)))
    for frame in frames:
        scan.fuse(frame)
    errors = {
        name: _of_scan(scan, dataclasses.replace(settings, normal_smoothing=angle))
        for name, angle in (("reflest", 0.0), ("smoothed", SMOOTHING))
    }
    errors["open3d"] = _by_surface(*_open3d_surface(frames, settings))
    surfaces = errors["reflest"]
    return {name: {of: found[name] for of, found in errors.items()} for name in surfaces}


def _of_scan(scan: Scan, settings: FusionSettings) -> dict[str, Any]:
    surface = observed_surface(scan.store, scan.views, settings, scan.voxel_count)
    is_seen = surface.observation_counts >= LEAST_FRAMES
    stated = normal_deviations(surface.positions, surface.normals)[is_seen]
    return _by_surface(surface.positions[is_seen], surface.normals[is_seen], stated)


def _by_surface(
    positions: NDArray[np.float32],
    normals: NDArray[np.float32],
    stated: NDArray[np.float32] | None = None,
) -> dict[str, Any]:
    owner, truth = surface_of(positions)
    cosine = np.einsum("ij,ij->i", truth, normals.astype(np.float64))
    error = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    is_clear = rim_distance(positions) > RIM
    found: dict[str, Any] = {}
    for index, name in enumerate([*(f"{radius:g}" for radius in RADII), "flat"]):
        chosen = is_clear & (owner == index)
        row = {f"p{100 * q:.0f}": float(np.quantile(error[chosen], q)) for q in SHARES}
        row["rms"] = float(np.sqrt(np.mean(error[chosen] ** 2)))
        row["points"] = int(chosen.sum())
        if stated is not None:
            # Two tangent axes make the angle: its mean square is twice the variance about one.
            row["stated_rms"] = float(
                np.degrees(np.sqrt(2.0 * np.mean(stated[chosen].astype(np.float64) ** 2)))
            )
        found[name] = row
    return found


def _open3d_surface(
    frames: list[Frame], settings: FusionSettings
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Points and normals of Open3D's fusion of the frames, at the same voxel size."""
    o3d = open3d()
    core = o3d.core
    grid = o3d.t.geometry.VoxelBlockGrid(
        ("tsdf", "weight"),
        (core.float32, core.float32),
        ((1), (1)),
        settings.voxel_size,
        8,
        20_000,
        core.Device("CPU:0"),
    )
    for frame in frames:
        depth = o3d.t.geometry.Image(core.Tensor(np.ascontiguousarray(frame.depth)))
        camera = core.Tensor(frame.intrinsics.matrix)
        extrinsic = core.Tensor(np.linalg.inv(frame.T_world_camera))
        limits = (1.0, settings.max_depth, settings.truncation)
        blocks = grid.compute_unique_block_coordinates(depth, camera, extrinsic, *limits)
        grid.integrate(blocks, depth, camera, extrinsic, *limits)
    points = grid.extract_point_cloud(LEAST_FRAMES)
    return points.point.positions.numpy(), points.point.normals.numpy()


def page_text(results: dict[str, Any]) -> str:
    """Lay the figures out.

    Args:
        results: Result of :func:`measure`.

    Returns:
        Markdown.
    """
    lines = [
        "# Normals of fused surfaces",
        "",
        "Angle between fused and true normals, degrees, of spheres and a table at 0.6 m, scanned "
        f"in {FRAMES} VGA frames with voxels of 5 mm; points within {1000 * RIM:.0f} mm of an edge "
        "are left out. Noise: 1.2 mm at 0.4 m and more beyond, independent from pixel to pixel or "
        "correlated over 1.5 pixels; depth in whole millimetres. Open3D: `VoxelBlockGrid` of the "
        "same frames and voxels. *Smoothed*: with `fusion.normal_smoothing` at "
        f"{SMOOTHING:g} degrees. *Stated*: RMS of the deviations by which the likelihood of "
        "roughness widens its lobes, from the spread of the normals around each voxel. Written by "
        "`python -m benchmarks.measurements.normals`.",
        "",
        "| noise | surface | median | smoothed | Open3D | p90 | smoothed | Open3D | RMS | stated | "
        "RMS, smoothed | stated |",
        "| --- " * 12 + "|",
    ]
    for noise, surfaces in results.items():
        for name, row in surfaces.items():
            fused, smoothed, theirs = row["reflest"], row["smoothed"], row["open3d"]
            what = "flat" if name == "flat" else f"radius {1000 * float(name):g} mm"
            cells = (
                *(of["p50"] for of in (fused, smoothed, theirs)),
                *(of["p90"] for of in (fused, smoothed, theirs)),
                *(of[which] for of in (fused, smoothed) for which in ("rms", "stated_rms")),
            )
            figures = " | ".join(f"{cell:.2f}" for cell in cells)
            lines.append(f"| {noise} | {what} | {figures} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measure and write both files."""
    results = measure()
    folder = ROOT / "docs" / "results"
    write_whole(folder / "normals.json", (json.dumps(results, indent=1) + "\n").encode())
    write_whole(folder / "normals.md", page_text(results).encode())


if __name__ == "__main__":
    main()
