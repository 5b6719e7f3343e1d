# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf generate``: the sparse data set."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from reflest_core.cli.synbrdf.set_options import add_set_options, generation_of
from reflest_core.cli.synbrdf.worker_options import add_worker_options, workers_of


def add_parser(products: Any) -> None:
    """Add the subcommand.

    Args:
        products: the subcommands of ``reflest synbrdf``.
    """
    parser: argparse.ArgumentParser = products.add_parser(
        "generate", help="sparse scenes for training: each surface point's colour from each view"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder; resumes if it exists")
    add_set_options(parser)
    parser.add_argument("--points", type=int, default=400, help="surface points of a scene")
    parser.add_argument("--samples", type=int, default=64, help="paths of an observation")
    add_worker_options(parser, "processes, each with all cores")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Generate until every shard is there.

    Args:
        arguments: all options of the command.
    """
    from reflest_core.synbrdf.generation.generate import generate

    workers = workers_of(arguments)
    generation = generation_of(arguments, arguments.points, arguments.samples)
    generate(arguments.out, generation, workers)
    return 0
