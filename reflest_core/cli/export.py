# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest export``: an estimate as a material for a renderer, a viewer or a simulator."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

EPILOG = """gltf, glb: glTF 2.0 with KHR_materials_specular; usd: UsdPreviewSurface as .usda;
mitsuba: a scene with our plugin reflest_ward, which is the estimate exactly; mitsuba-stock: a scene
that needs no plugin; hdr, exr: the light around the object, as an equirectangular environment.
docs/export.md tells how the values are mapped and how near that comes."""


def add_parser(subparsers: Any) -> None:
    """Add the subcommand."""
    from reflest_core.export.environment_file import LIGHT_FORMATS
    from reflest_core.export.material_file import FORMATS

    parser: argparse.ArgumentParser = subparsers.add_parser(
        "export",
        help="write an estimate as a material (glTF, USD, Mitsuba), or a scan's light",
        epilog=EPILOG,
    )
    parser.add_argument(
        "source",
        type=Path,
        metavar="ESTIMATE.json|SCAN",
        help="what reflest replay --json wrote; for hdr and exr a saved scan",
    )
    parser.add_argument("--format", choices=[*FORMATS, *LIGHT_FORMATS], required=True)
    parser.add_argument("--out", type=Path, required=True, metavar="FILE")
    parser.add_argument(
        "--environment",
        type=Path,
        metavar="FILE",
        help="light the scene with this .hdr or .exr file (usd, mitsuba, mitsuba-stock)",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read the estimate or the scan, write the material or the light."""
    from reflest_core.export.environment_file import LIGHT_FORMATS, export_environment
    from reflest_core.export.errors import ExportError
    from reflest_core.export.estimate_file import read_estimate
    from reflest_core.export.material_file import export_estimate
    from reflest_core.fusion.scan import Scan

    if options.format not in LIGHT_FORMATS:
        estimate = read_estimate(options.source)
        export_estimate(estimate, options.format, options.out, options.environment)
    elif options.environment is not None:
        raise ExportError(f"--environment lights a material; {options.format} is the light itself")
    else:
        export_environment(Scan.load(options.source).snapshot(), options.format, options.out)
    print(f"wrote {options.out}")
    return 0
