# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf tabletop``: an RGB-D scan of objects on a table as a bag."""

from __future__ import annotations

import argparse
import shlex
from typing import Any

from reflest_core.cli.synbrdf.film_options import add_film_options, film_command, film_options
from reflest_core.cli.synbrdf.set_options import materials_of, realism_of


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
        choices=("distant", "near"),
        help="an environment map, or lamps and windows of a room; default: drawn",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Render the bag.

    Args:
        arguments: all options of the command.
    """
    from reflest_core.synbrdf.tabletop.ground import Setting
    from reflest_core.synbrdf.tabletop.tabletop_bag import TabletopRequest, write_tabletop
    from reflest_core.synbrdf.tabletop.tabletop_scene import TabletopChoices, TabletopLight

    command = film_command(arguments, "tabletop")
    for name in ("setting", "light"):
        if getattr(arguments, name) is not None:
            command += [f"--{name}", getattr(arguments, name)]
    choices = TabletopChoices(
        None if arguments.setting is None else Setting(arguments.setting),
        None if arguments.light is None else TabletopLight(arguments.light),
    )
    request = TabletopRequest(
        **film_options(arguments),
        materials=materials_of(arguments),
        choices=choices,
        realism=realism_of(arguments),
    )
    write_tabletop(arguments.out, request, shlex.join(command))
    return 0
