# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Workers of a Dask cluster that render shards (the extra ``cluster``)."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import Any

from reflest_core.errors import ReflestError

CONNECT_SECONDS = 5.0


class ClusterError(ReflestError):
    """The Dask cluster cannot be used."""


@contextmanager
def dask_cluster(address: str) -> Iterator[Executor]:
    """Run tasks on the workers of a Dask scheduler.

    Args:
        address: of the scheduler, such as ``tcp://host:8786``.

    Raises:
        ClusterError: without the package, without an answer, or without workers.
    """
    try:
        from distributed import Client, KilledWorker
        from distributed.comm.core import CommClosedError
    except ImportError as error:
        raise ClusterError(
            "--scheduler needs the Python package distributed: install it with "
            "pip install 'reflest-ros[cluster]'"
        ) from error
    try:
        client: Any = Client(address, timeout=CONNECT_SECONDS)
    except (OSError, ValueError, TimeoutError) as error:
        raise ClusterError(
            f"no Dask scheduler answers at {address}: start one with 'dask scheduler' and give its "
            "address"
        ) from error
    with client:
        if not client.scheduler_info(n_workers=-1)["workers"]:
            raise ClusterError(
                f"the Dask scheduler at {address} has no workers: start some with "
                f"'dask worker {address} --nthreads 1'"
            )
        try:
            yield client.get_executor(pure=False)
        except (KilledWorker, CommClosedError) as error:
            raise ClusterError(
                f"the cluster at {address} lost its workers or its scheduler, perhaps for want of "
                "memory: start them again, and the same command goes on"
            ) from error
