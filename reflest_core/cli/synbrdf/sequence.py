# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf sequence``: an RGB-D scan as a bag."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path
from typing import Any

from reflest_core.brdf.parameters import WardParameters
from reflest_core.cli.synbrdf.set_options import add_realism_option, realism_of


def add_parser(products: Any) -> None:
    """Add the subcommand."""
    parser: argparse.ArgumentParser = products.add_parser(
        "sequence", help="an RGB-D scan of one object as an MCAP ROS 2 bag, with its truth"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder of the bag; must not exist")
    parser.add_argument("--seed", type=int, default=1, help="decides what no option decides")
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--width", type=int, default=640, help="pixels")
    parser.add_argument("--height", type=int, default=480, help="pixels")
    parser.add_argument("--samples", type=int, default=64, help="paths of a pixel")
    parser.add_argument("--rate", type=float, default=10.0, help="frames a second")
    parser.add_argument(
        "--material",
        type=float,
        nargs=5,
        metavar=("R", "G", "B", "RHO_S", "ALPHA"),
        help="Ward parameters, rho_d in linear sRGB; default: drawn",
    )
    parser.add_argument("--shape", metavar="KIND", help="kind of procedural shape; default: drawn")
    parser.add_argument(
        "--environments", type=Path, help=".hdr, .exr or .npz files; default: procedural skies"
    )
    parser.add_argument("--meshes", type=Path, help=".obj, .ply or .npz; default: procedural")
    add_realism_option(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Render the bag."""
    from reflest_core.synbrdf.sequences.sequence_scene import SequenceRequest

    options = {
        key: value
        for key, value in vars(arguments).items()
        if key not in ("run", "out", "material", "realism") and value is not None
    }
    material = None
    if arguments.material is not None:
        red, green, blue, rho_s, alpha = arguments.material
        material = WardParameters((red, green, blue), rho_s, alpha)
    request = SequenceRequest(**options, material=material, realism=realism_of(arguments))
    command = ["reflest", "synbrdf", "sequence", "--out", str(arguments.out)]
    command += [word for key, value in options.items() for word in (f"--{key}", str(value))]
    if arguments.material is not None:
        command += ["--material", *map(str, arguments.material)]
    if arguments.realism is not None:
        command += ["--realism", *arguments.realism]

    from reflest_core.synbrdf.sequences.sequence import write_sequence

    write_sequence(arguments.out, request, shlex.join(command))
    return 0
