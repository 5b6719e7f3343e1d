# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf measure``: what the constants of realism were set by."""

from __future__ import annotations

import argparse
from typing import Any

from reflest_core.cli.synbrdf.set_options import add_set_options, generation_of

QUALITIES = (60, 70, 80, 90, 95)


def add_parser(products: Any) -> None:
    """Add the subcommand.

    Args:
        products: the subcommands of ``reflest synbrdf``.
    """
    parser: argparse.ArgumentParser = products.add_parser(
        "measure",
        help="errors of real fusion and of a JPEG codec on renders, and of shapes' normals",
    )
    parser.add_argument("what", choices=("fusion", "jpeg", "shading"))
    parser.add_argument("--objects", type=int, default=5, help="how many are rendered")
    parser.add_argument("--scan-frames", type=int, default=60, help="of a scan, for fusion")
    parser.add_argument("--voxel-size", type=float, default=0.005, help="metres, for fusion")
    add_set_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print one table.

    Args:
        arguments: all options of the command.
    """
    {"fusion": _fusion, "jpeg": _jpeg, "shading": _shading}[arguments.what](arguments)
    return 0


def _fusion(arguments: argparse.Namespace) -> None:
    from reflest_core.synbrdf.measurement.fusion_error import FusionError, measure
    from reflest_core.synbrdf.realism.depth_sensor import DepthSensor
    from reflest_core.synbrdf.realism.settings import Effect, Realism
    from reflest_core.synbrdf.sequences.sequence_scene import SequenceRequest
    from reflest_core.synbrdf.shapes.procedural import KINDS

    exact, kinect = DepthSensor(0.0, 0.0), DepthSensor(1.0, 1.0)
    still, tracked = Realism.only([]), Realism.only([Effect.POSE])
    cases = {
        "exact": (exact, still),
        "depth": (kinect, still),
        "pose": (exact, tracked),
        "depth and pose": (kinect, tracked),
    }
    print("| faults | voxels | tilt, median (deg) | tilt, p90 (deg) | offset (mm) |")
    print("|---|---|---|---|---|")
    kinds = list(KINDS)
    for name, (sensor, tracking) in cases.items():
        errors = []
        for number in range(arguments.objects):
            request = SequenceRequest(
                seed=arguments.seed + number // len(kinds),
                frames=arguments.scan_frames,
                shape=kinds[number % len(kinds)],
            )
            errors.append(measure(request, sensor, tracking, arguments.voxel_size))
        joined = FusionError.joined(errors)
        row = joined.quantiles()
        print(
            f"| {name} | {len(joined.tilt)} | {row['tilt_median']:.2f} | {row['tilt_p90']:.2f} "
            f"| {1000.0 * row['offset_stddev']:.2f} |"
        )


def _jpeg(arguments: argparse.Namespace) -> None:
    from reflest_core.synbrdf.measurement.jpeg_error import jpeg_error, rendered_images

    images = rendered_images(generation_of(arguments), arguments.objects)
    print("| quality | Y | Cb | Cr |")
    print("|---|---|---|---|")
    for quality in QUALITIES:
        y, cb, cr = jpeg_error(images, quality)
        print(f"| {quality} | {y:.2f} | {cb:.2f} | {cr:.2f} |")


def _shading(arguments: argparse.Namespace) -> None:
    from reflest_core.synbrdf.measurement.shading_error import poor_share
    from reflest_core.synbrdf.shapes.procedural import KINDS

    print("| shapes | area more than 10 deg off (%) | more than 20 deg off (%) |")
    print("|---|---|---|")
    for kind in KINDS:
        shares = [100.0 * poor_share(kind, range(arguments.objects), off) for off in (10.0, 20.0)]
        print(f"| {kind} | {shares[0]:.1f} | {shares[1]:.1f} |")
