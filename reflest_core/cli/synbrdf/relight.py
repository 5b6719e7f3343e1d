# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf relight``: training scenes of other materials under other lights."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from reflest_core.cli.synbrdf.worker_options import add_worker_options, workers_of


def add_parser(products: Any) -> None:
    """Add the subcommand.

    Args:
        products: the subcommands of ``reflest synbrdf``.
    """
    parser: argparse.ArgumentParser = products.add_parser(
        "relight", help="training scenes of other materials under other lights, without rendering"
    )
    parser.add_argument("source", type=Path, help="folder that synbrdf generate made")
    parser.add_argument("--out", type=Path, required=True, help="folder; resumes if it exists")
    parser.add_argument("--environments", type=Path, help="those of the source")
    parser.add_argument("--extra-environments", type=Path, help="further ones")
    parser.add_argument(
        "--without", nargs="*", default=[], metavar="NAME", help="environments to leave out"
    )
    parser.add_argument("--copies", type=int, default=1, help="of each scene")
    parser.add_argument(
        "--natural",
        type=float,
        default=0.5,
        metavar="SHARE",
        help="of the scenes are lit by one environment as it is; the others as diverse light is",
    )
    add_worker_options(parser, "processes")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Relight until every shard is there.

    Args:
        arguments: all options of the command.
    """
    from reflest_core.synbrdf.relit.relighting import Relighting, relight

    relighting = Relighting(
        arguments.source,
        arguments.copies,
        arguments.environments,
        arguments.extra_environments,
        tuple(arguments.without),
        arguments.natural,
    )
    relight(arguments.out, relighting, workers_of(arguments))
    return 0
