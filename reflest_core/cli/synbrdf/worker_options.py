# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Who makes the shards of a data set: processes of this machine, or a Dask cluster."""

from __future__ import annotations

import argparse
from concurrent.futures import Executor
from contextlib import AbstractContextManager


def add_worker_options(parser: argparse.ArgumentParser, jobs: str) -> None:
    """Add ``--jobs`` and ``--scheduler``.

    Args:
        parser: takes the options.
        jobs: what the processes are used for, in the help.
    """
    workers = parser.add_mutually_exclusive_group()
    workers.add_argument("--jobs", type=int, default=1, help=jobs)
    workers.add_argument(
        "--scheduler", metavar="ADDRESS", help="use the workers of this Dask scheduler instead"
    )


def workers_of(arguments: argparse.Namespace) -> AbstractContextManager[Executor]:
    """Not yet begun. Raises ``GenerationRefused`` for fewer than one process.

    Args:
        arguments: all options of the command.
    """
    from reflest_core.synbrdf.generation.dask_cluster import dask_cluster
    from reflest_core.synbrdf.generation.data_set import GenerationRefused
    from reflest_core.synbrdf.generation.process_pool import process_pool

    if arguments.scheduler is not None:
        return dask_cluster(arguments.scheduler)
    if arguments.jobs < 1:
        raise GenerationRefused(f"--jobs is {arguments.jobs}, but must be 1 or more")
    return process_pool(arguments.jobs)
