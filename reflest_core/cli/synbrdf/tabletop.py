# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf tabletop``: an RGB-D scan of objects on a table as a bag."""

from __future__ import annotations

import argparse
import shlex
from typing import TYPE_CHECKING, Any

from reflest_core.brdf.parameters import WardParameters
from reflest_core.cli.synbrdf.film_options import add_film_options, film_command, film_options
from reflest_core.cli.synbrdf.set_options import materials_of, realism_of

if TYPE_CHECKING:
    from reflest_core.synbrdf.tabletop.objects import ChosenObject


def add_parser(products: Any) -> None:
    """Add the subcommand.

    Args:
        products: the subcommands of ``reflest synbrdf``.
    """
    parser: argparse.ArgumentParser = products.add_parser(
        "tabletop",
        help="an RGB-D scan of 2 to 6 objects of several materials as an MCAP ROS 2 bag, with "
        "the truth of every surface point",
    )
    add_film_options(parser, frames=48, samples=32)
    parser.add_argument(
        "--setting",
        choices=("table", "corner"),
        help="what objects stand on: a table, or the floor in a corner of two walls; "
        "default: drawn",
    )
    parser.add_argument(
        "--light",
        choices=("distant", "diverse", "near"),
        help="an environment map, a new one mixed of those given (for training), or lamps and "
        "windows of a room; default: one of the first and the last, drawn",
    )
    parser.add_argument(
        "--table-material",
        type=float,
        nargs=5,
        metavar=("R", "G", "B", "RHO_S", "ALPHA"),
        help="Ward parameters of a table without a pattern, rho_d in linear sRGB; default: drawn",
    )
    parser.add_argument(
        "--object",
        nargs=6,
        action="append",
        default=[],
        metavar=("KIND", "R", "G", "B", "RHO_S", "ALPHA"),
        help="an object: its kind of procedural shape and its Ward parameters; once for each, "
        "default: 2 to 6 are drawn",
    )
    parser.add_argument(
        "--truth-points",
        type=int,
        metavar="N",
        help="points spread over all surfaces; truth.ply holds those that are seen "
        "(default: 200000)",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Render the bag.

    Args:
        arguments: all options of the command.
    """
    from reflest_core.synbrdf.tabletop.ground import Setting
    from reflest_core.synbrdf.tabletop.tabletop_bag import (
        TRUTH_POINTS,
        TabletopRequest,
        write_tabletop,
    )
    from reflest_core.synbrdf.tabletop.tabletop_scene import TabletopChoices, TabletopLight

    command = film_command(arguments, "tabletop")
    for name in ("setting", "light"):
        if getattr(arguments, name) is not None:
            command += [f"--{name}", getattr(arguments, name)]
    if arguments.truth_points is not None:
        command += ["--truth-points", str(arguments.truth_points)]
    if arguments.table_material is not None:
        command += ["--table-material", *map(str, arguments.table_material)]
    for words in arguments.object:
        command += ["--object", *words]
    choices = TabletopChoices(
        None if arguments.setting is None else Setting(arguments.setting),
        None if arguments.light is None else TabletopLight(arguments.light),
        ground=None if arguments.table_material is None else _ward(*arguments.table_material),
        objects=tuple(_chosen_object(words) for words in arguments.object),
    )
    request = TabletopRequest(
        **film_options(arguments),
        materials=materials_of(arguments),
        choices=choices,
        realism=realism_of(arguments),
        truth_points=TRUTH_POINTS if arguments.truth_points is None else arguments.truth_points,
    )
    write_tabletop(arguments.out, request, shlex.join(command))
    return 0


def _ward(red: float, green: float, blue: float, rho_s: float, alpha: float) -> WardParameters:
    return WardParameters((red, green, blue), rho_s, alpha)


def _chosen_object(words: list[str]) -> ChosenObject:
    from reflest_core.synbrdf.sequences.sequence_scene import SequenceRefused
    from reflest_core.synbrdf.tabletop.objects import ChosenObject

    try:
        values = [float(word) for word in words[1:]]
    except ValueError:
        raise SequenceRefused(
            f"--object is {' '.join(words)}, but must be a kind of shape and five numbers"
        ) from None
    return ChosenObject(words[0], _ward(*values))
