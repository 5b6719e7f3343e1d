# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf generate``: the sparse data set."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from reflest_core.cli.synbrdf.set_options import add_set_options, generation_of


def add_parser(products: Any) -> None:
    """Add the subcommand."""
    parser: argparse.ArgumentParser = products.add_parser(
        "generate", help="sparse scenes for training: each surface point's colour from each view"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder; resumes if it exists")
    add_set_options(parser)
    parser.add_argument("--points", type=int, default=400, help="surface points of a scene")
    parser.add_argument("--samples", type=int, default=64, help="paths of an observation")
    workers = parser.add_mutually_exclusive_group()
    workers.add_argument("--jobs", type=int, default=1, help="processes, each with all cores")
    workers.add_argument(
        "--scheduler", metavar="ADDRESS", help="use the workers of this Dask scheduler instead"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Generate until every shard is there."""
    from reflest_core.synbrdf.dask_cluster import dask_cluster
    from reflest_core.synbrdf.generate import generate
    from reflest_core.synbrdf.generation import GenerationRefused
    from reflest_core.synbrdf.process_pool import process_pool

    if arguments.jobs < 1:
        raise GenerationRefused(f"--jobs is {arguments.jobs}, but must be 1 or more")
    generation = generation_of(arguments, arguments.points, arguments.samples)
    if arguments.scheduler is None:
        workers = process_pool(arguments.jobs)
    else:
        workers = dask_cluster(arguments.scheduler)
    generate(arguments.out, generation, workers)
    return 0
