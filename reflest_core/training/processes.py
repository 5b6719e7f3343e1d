# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The processes that train together: alone, or as torchrun's environment variables say."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import torch
from torch import distributed

from reflest_core.training.data.sample import TrainingError

TORCHRUN = ("RANK", "WORLD_SIZE", "LOCAL_RANK", "MASTER_ADDR", "MASTER_PORT")


@dataclass(frozen=True)
class Processes:
    """Number ``rank`` of ``count`` processes, computing on ``device``."""

    rank: int
    count: int
    device: torch.device

    @property
    def is_first(self) -> bool:
        """The first one validates, logs and writes."""
        return self.rank == 0

    def parts(self, total: int) -> range:
        """The parts of a minibatch that this process draws."""
        if total % self.count:
            raise TrainingError(
                f"{total} parts of a minibatch cannot be shared by {self.count} processes; "
                f"give --parts a multiple of {self.count}"
            )
        return range(self.rank, total, self.count)

    @contextmanager
    def first_alone(self) -> Iterator[None]:
        """The first process goes through it before the others, so that it can make files."""
        if not self.is_first:
            distributed.barrier()
        yield
        if self.is_first and self.count > 1:
            distributed.barrier()


@contextmanager
def joined_processes(device: str) -> Iterator[Processes]:
    """Join the group that torchrun describes, gloo on CPUs and NCCL on GPUs; alone without one."""
    if "RANK" not in os.environ:
        yield Processes(0, 1, _device(device, 0))
        return
    missing = [name for name in TORCHRUN if name not in os.environ]
    if missing:
        raise TrainingError(f"RANK is set but {', '.join(missing)} is not; start with torchrun")
    own = _device(device, int(os.environ["LOCAL_RANK"]))
    distributed.init_process_group("gloo" if own.type == "cpu" else "nccl")
    try:
        yield Processes(distributed.get_rank(), distributed.get_world_size(), own)
        # The first one writes while others are done: who leaves early closes what it still uses.
        distributed.barrier()
    finally:
        distributed.destroy_process_group()


def _device(name: str, local_rank: int) -> torch.device:
    if name == "auto":
        name = "cuda" if torch.cuda.is_available() else "cpu"
    if name == "cpu":
        return torch.device("cpu")
    if not torch.cuda.is_available():
        raise TrainingError(f"there is no CUDA device for --device {name}; use --device cpu")
    if name == "cuda":
        name = f"cuda:{local_rank}"
        torch.cuda.set_device(local_rank)
    return torch.device(name)
