# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Options that sequences and tabletops share: how a scene is filmed."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from reflest_core.cli.synbrdf.set_options import add_material_options, add_realism_option

FILM_OPTIONS = ("seed", "frames", "width", "height", "samples", "rate", "environments", "meshes")


def add_film_options(parser: argparse.ArgumentParser, frames: int, samples: int) -> None:
    """Add the options.

    Args:
        parser: takes the options.
        frames: default number of frames.
        samples: default paths of a pixel.
    """
    parser.add_argument("--out", type=Path, required=True, help="folder of the bag; must not exist")
    parser.add_argument("--seed", type=int, default=1, help="decides what no option decides")
    parser.add_argument("--frames", type=int, default=frames)
    parser.add_argument("--width", type=int, default=640, help="pixels")
    parser.add_argument("--height", type=int, default=480, help="pixels")
    parser.add_argument("--samples", type=int, default=samples, help="paths of a pixel")
    parser.add_argument("--rate", type=float, default=10.0, help="frames a second")
    parser.add_argument(
        "--environments", type=Path, help=".hdr, .exr or .npz files; default: procedural skies"
    )
    parser.add_argument("--meshes", type=Path, help=".obj, .ply or .npz; default: procedural")
    add_material_options(parser)
    add_realism_option(parser)


def film_options(arguments: argparse.Namespace) -> dict[str, Any]:
    """Values of :data:`FILM_OPTIONS` that were given or have a default, by name.

    Args:
        arguments: all options of the command.
    """
    values = {name: getattr(arguments, name) for name in FILM_OPTIONS}
    return {name: value for name, value in values.items() if value is not None}


def film_command(arguments: argparse.Namespace, product: str) -> list[str]:
    """The command line that asks for the same again.

    Args:
        arguments: all options of the command.
        product: name of the subcommand.
    """
    command = ["reflest", "synbrdf", product, "--out", str(arguments.out)]
    for name, value in film_options(arguments).items():
        command += [f"--{name}", str(value)]
    if arguments.materials != "opensurfaces":
        command += ["--materials", arguments.materials]
    if arguments.material_fits is not None:
        command += ["--material-fits", str(arguments.material_fits)]
    if arguments.measured_share != 1.0:
        command += ["--measured-share", str(arguments.measured_share)]
    if arguments.realism is not None:
        command += ["--realism", *arguments.realism]
    return command
