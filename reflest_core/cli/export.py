# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest export``: an estimate as a material for a renderer, a viewer or a simulator."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

EPILOG = """gltf, glb: glTF 2.0 with KHR_materials_specular; usd: UsdPreviewSurface as .usda;
mitsuba: a scene with our plugin reflest_ward, which is the estimate exactly; mitsuba-stock: a scene
that needs no plugin. docs/export.md tells how the values are mapped and how near that comes."""


def add_parser(subparsers: Any) -> None:
    """Add the subcommand."""
    from reflest_core.export.material_file import FORMATS

    parser: argparse.ArgumentParser = subparsers.add_parser(
        "export", help="write an estimate as a material (glTF, USD, Mitsuba)", epilog=EPILOG
    )
    parser.add_argument(
        "estimate", type=Path, metavar="ESTIMATE.json", help="what reflest replay --json wrote"
    )
    parser.add_argument("--format", choices=FORMATS, required=True)
    parser.add_argument("--out", type=Path, required=True, metavar="FILE")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Read the estimate, write the material."""
    from reflest_core.export.estimate_file import read_estimate
    from reflest_core.export.material_file import export_estimate

    export_estimate(read_estimate(options.estimate), options.format, options.out)
    print(f"wrote {options.out}")
    return 0
