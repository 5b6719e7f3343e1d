# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The processes that train together, and their memory."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import torch
from torch import distributed

from reflest_core.training.data.sample import TrainingError

M_TRIM_THRESHOLD, M_MMAP_THRESHOLD, M_ARENA_MAX = -1, -3, -8
"""From glibc's ``malloc.h``."""
LARGEST_KEPT = 1 << 30
"""Bytes, of a block and of what is kept free."""
TORCHRUN = ("RANK", "WORLD_SIZE", "LOCAL_RANK", "MASTER_ADDR", "MASTER_PORT")


@dataclass(frozen=True)
class Processes:
    """One of the processes that train together.

    Attributes:
        rank: Its number, from 0.
        count: How many there are.
        device: Where it computes.
    """

    rank: int
    count: int
    device: torch.device

    @property
    def is_first(self) -> bool:
        """Whether it is the first, which validates, logs and writes."""
        return self.rank == 0

    def parts(self, total: int) -> range:
        """Return the parts, of ``total`` of a minibatch, that this process draws.

        Args:
            total: Parts of a minibatch.

        Raises:
            TrainingError: The parts cannot be shared equally.
        """
        if total % self.count:
            raise TrainingError(
                f"{total} parts of a minibatch cannot be shared by {self.count} processes; "
                f"give --parts a multiple of {self.count}"
            )
        return range(self.rank, total, self.count)

    @contextmanager
    def first_alone(self) -> Iterator[None]:
        """Let the first process through before the others, so that it can make files."""
        if not self.is_first:
            distributed.barrier()
        yield
        if self.is_first and self.count > 1:
            distributed.barrier()


@contextmanager
def joined_processes(device: str) -> Iterator[Processes]:
    """Join the group that torchrun describes, by gloo on CPUs and NCCL on GPUs.

    Without torchrun's environment variables the process is alone.

    Args:
        device: ``auto``, ``cpu``, ``cuda`` or ``cuda:N``.

    Raises:
        TrainingError: Some of torchrun's variables are missing, or there is no such device.
    """
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


def keep_freed_memory() -> None:
    """Have glibc's allocator keep freed memory for the next minibatch.

    Asking the kernel for it again costs a third of a training's time. With another allocator this
    does nothing.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(M_ARENA_MAX, 1)  # what the drawing thread frees, the training thread takes
        mallopt(M_MMAP_THRESHOLD, LARGEST_KEPT)
        mallopt(M_TRIM_THRESHOLD, LARGEST_KEPT)


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
