# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest export``: the scanned surface with its materials, for simulators and renderers."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reflest_core.cli.output_files import check_overwriting
from reflest_core.cli.scan_options import (
    add_scan_options,
    check_capture_options,
    check_paths,
    is_saved,
)

if TYPE_CHECKING:
    from reflest_core.estimation.pipeline import Pipeline
    from reflest_core.export.asset import Asset

EPILOG = """glb, gltf: glTF 2.0 with KHR_materials_specular. usd: .usda, .usdc or .usdz with
UsdPreviewSurface and OpenPBR. sdf: a static model for gz-sim. obj, ply: the mesh. mitsuba: a scene
with the plugin reflest_ward, which is the estimate exactly; mitsuba-stock: a scene that needs no
plugin. hdr, exr: the light around the object. The surface needs the extra asset:
pip install 'reflest-ros[asset]'. docs/export.md says how the values are mapped and how near that
comes."""


def add_parser(subparsers: Any) -> None:
    """Add the subcommand.

    Args:
        subparsers: What :meth:`argparse.ArgumentParser.add_subparsers` returned.
    """
    from reflest_core.export.environment_file import LIGHT_FORMATS
    from reflest_core.export.exporter import FORMATS

    with_light = ", ".join(name for name, one in FORMATS.items() if one.has_light)
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "export",
        help="write the scanned surface with its materials (glTF, USD, SDF, ...), or its light",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "capture",
        type=Path,
        metavar="SCAN|CAPTURE|ESTIMATE.json",
        help="a saved scan, or a capture to scan; with --sphere also what replay --json wrote",
    )
    parser.add_argument("--format", choices=[*FORMATS, *LIGHT_FORMATS], required=True)
    parser.add_argument("--out", type=Path, required=True, metavar="FILE")
    parser.add_argument(
        "--faces", type=int, metavar="N", help="triangles of the surface; default: 20000"
    )
    parser.add_argument(
        "--texture",
        type=int,
        metavar="PIXELS",
        help="edge of the base colour texture; default: two pixels for each voxel",
    )
    parser.add_argument(
        "--watertight",
        action="store_true",
        help="a closed solid; what was scanned from above, as a table, gets a flat base",
    )
    parser.add_argument(
        "--sphere", action="store_true", help="a 10 cm sphere of the material, not the surface"
    )
    parser.add_argument(
        "--environment",
        type=Path,
        metavar="FILE",
        help=f"with --sphere: light it with this .hdr or .exr file ({with_light})",
    )
    add_scan_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Write what was asked for.

    Args:
        options: The parsed command line.

    Returns:
        The exit status.

    Raises:
        ReflestError: A bad option, an unreadable source, or nothing to export.
    """
    check_paths(options, inputs=("environment",), outputs=("out",))
    check_capture_options(options)
    from reflest_core.export.environment_file import LIGHT_FORMATS, export_environment

    _refuse_contradictions(options)
    if options.format in LIGHT_FORMATS:
        surface = _scanned(options).snapshot().surface
        export_environment(surface, options.format, options.out)
    else:
        asset = _sphere(options) if options.sphere else _surface(options)
        if asset.warning:
            print(f"reflest: warning: {asset.warning}", file=sys.stderr)
    print(f"wrote {options.out}")
    return 0


def _refuse_contradictions(options: argparse.Namespace) -> None:
    """Refuse a wrong suffix, and options that would change nothing in what is written."""
    from reflest_core.export.environment_file import LIGHT_FORMATS
    from reflest_core.export.errors import ExportError, check_suffix
    from reflest_core.export.exporter import check_lit, checked_format

    of_surface = [
        f"--{name}" for name in ("faces", "texture") if getattr(options, name) is not None
    ]
    of_surface += ["--watertight"] if options.watertight else []
    if options.format in LIGHT_FORMATS:
        check_suffix(options.out, LIGHT_FORMATS[options.format], options.format)
        if options.environment is not None:
            raise ExportError(
                f"--environment lights a material; {options.format} is the light itself"
            )
        if unused := [*of_surface, *(["--sphere"] if options.sphere else [])]:
            raise ExportError(
                f"{unused[0]} is for a surface with its materials; {options.format} is the light "
                "alone: leave it out"
            )
        return
    checked_format(options.out, options.format)
    if options.sphere:
        if of_surface:
            raise ExportError(
                f"{of_surface[0]} is for the scanned surface: leave it or --sphere out"
            )
        if options.environment is not None:
            check_lit(options.environment, options.out, options.format)
    elif options.known_light is not None:
        for suffix in LIGHT_FORMATS.values():
            light = options.out.with_name(f"{options.out.stem}_environment{suffix}")
            check_overwriting({"beside --out:": light}, [Path(options.known_light)])


def _sphere(options: argparse.Namespace) -> Asset:
    from reflest_core.export.estimate_file import read_estimate
    from reflest_core.export.exporter import export_estimate

    if options.capture.suffix == ".json":
        estimate = read_estimate(options.capture)
    else:
        pipeline = _scanned(options)
        estimate = pipeline.estimate(pipeline.snapshot())
    return export_estimate(estimate, options.format, options.out, options.environment)


def _surface(options: argparse.Namespace) -> Asset:
    from reflest_core.export.errors import ExportError
    from reflest_core.export.exporter import check_libraries, export_scan
    from reflest_core.export.scan_asset import FACES, AssetSettings

    if options.environment is not None:
        raise ExportError(
            "--environment lights a sphere: add --sphere; a surface has its own light"
        )
    if options.capture.suffix == ".json":
        raise ExportError(
            f"{options.capture} holds an estimate and no surface: add --sphere, or give a saved "
            "scan (reflest replay CAPTURE --save-scan FILE)"
        )
    settings = AssetSettings(
        FACES if options.faces is None else options.faces,
        options.texture or 0,
        options.watertight,
        tuple(options.up) if options.up else (0.0, 0.0, 1.0),
    )
    check_libraries(options.format)
    pipeline = _scanned(options)
    found = pipeline.final_materials()
    return export_scan(pipeline.scan, found, options.out, options.format, settings)


def _scanned(options: argparse.Namespace) -> Pipeline:
    """The saved scan, or a scan of all frames of the capture."""
    from tqdm import tqdm

    from reflest_core.capture.refusal import CaptureError, FrameRefused
    from reflest_core.cli.scan_settings import scan_settings
    from reflest_core.cli.source import open_source
    from reflest_core.estimation.pipeline import Pipeline
    from reflest_core.jit import announce_compilation

    announce_compilation()
    settings = scan_settings(options)
    pipeline = Pipeline(settings)
    if is_saved(options.capture):
        pipeline.load(options.capture)
        return pipeline
    capture = open_source(
        options, settings.capture, on_clock_jump=lambda _: pipeline.restart_clock()
    )
    fused = 0
    with tqdm(total=capture.frame_total, unit="frame", disable=None) as bar:
        for frame in capture:
            bar.update(capture.frames_seen - bar.n)
            try:
                pipeline.fuse(frame)
                fused += 1
            except FrameRefused as refusal:
                capture.refuse(refusal)
    if not fused:
        reasons = "; ".join(capture.refusals.first_message.values())
        raise CaptureError(f"{capture.name} has no usable frame: {reasons or 'it is empty'}")
    return pipeline
