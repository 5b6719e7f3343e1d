# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf sequence``: an RGB-D scan of one object as a bag."""

from __future__ import annotations

import argparse
import shlex
from typing import Any

from reflest_core.brdf.parameters import WardParameters
from reflest_core.cli.synbrdf.film_options import add_film_options, film_command, film_options
from reflest_core.cli.synbrdf.set_options import materials_of, realism_of


def add_parser(products: Any) -> None:
    """Add the subcommand.

    Args:
        products: the subcommands of ``reflest synbrdf``.
    """
    parser: argparse.ArgumentParser = products.add_parser(
        "sequence", help="an RGB-D scan of one object as an MCAP ROS 2 bag, with its truth"
    )
    add_film_options(parser, frames=60, samples=64)
    parser.add_argument(
        "--material",
        type=float,
        nargs=5,
        metavar=("R", "G", "B", "RHO_S", "ALPHA"),
        help="Ward parameters, rho_d in linear sRGB; default: drawn",
    )
    parser.add_argument("--shape", metavar="KIND", help="kind of procedural shape; default: drawn")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Render the bag.

    Args:
        arguments: all options of the command.
    """
    from reflest_core.synbrdf.sequences.sequence_scene import SequenceRequest

    command = film_command(arguments, "sequence")
    material = None
    if arguments.material is not None:
        red, green, blue, rho_s, alpha = arguments.material
        material = WardParameters((red, green, blue), rho_s, alpha)
        command += ["--material", *map(str, arguments.material)]
    if arguments.shape is not None:
        command += ["--shape", arguments.shape]
    request = SequenceRequest(
        **film_options(arguments),
        material=material,
        shape=arguments.shape,
        materials=materials_of(arguments),
        realism=realism_of(arguments),
    )

    from reflest_core.synbrdf.sequences.sequence import write_sequence

    write_sequence(arguments.out, request, shlex.join(command))
    return 0
