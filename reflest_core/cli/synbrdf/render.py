# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf render``: a Mitsuba file with our BSDF, as an image."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any


def add_parser(products: Any) -> None:
    """Add the subcommand.

    Args:
        products: the subcommands of ``reflest synbrdf``.
    """
    parser: argparse.ArgumentParser = products.add_parser(
        "render", help="render a Mitsuba 3 file that uses the plugin reflest_ward"
    )
    parser.add_argument("scene", type=Path, help="scene.xml")
    parser.add_argument("--out", type=Path, required=True, help=".exr: linear sRGB radiance")
    parser.add_argument("--sensor", type=int, default=0, help="which of the file's sensors")
    parser.add_argument("--samples", type=int, help="paths of a pixel; default: the file's")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Render one sensor.

    Args:
        arguments: all options of the command.
    """
    from reflest_core.synbrdf.path_tracing.image_files import write_exr
    from reflest_core.synbrdf.path_tracing.xml_render import SceneUnreadable, render_xml

    if arguments.out.suffix.lower() != ".exr":
        raise SceneUnreadable(f"--out {arguments.out} must end in .exr")
    image = render_xml(arguments.scene, arguments.sensor, arguments.samples)
    try:
        write_exr(arguments.out, image)
    except OSError as error:
        raise SceneUnreadable(f"{arguments.out} cannot be written: {error}") from error
    return 0
