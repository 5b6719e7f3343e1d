# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Spreads long computations over frames, so that none of them delays a frame for long."""

from __future__ import annotations

from collections.abc import Iterator


class StepwiseWork:
    """A computation written as a generator, of which each frame does a few steps.

    The number of steps is fixed, not their time: results are the same from run to run.
    """

    def __init__(self) -> None:
        self._steps: Iterator[None] | None = None

    @property
    def is_running(self) -> bool:
        """Whether steps are left."""
        return self._steps is not None

    def start(self, steps: Iterator[None]) -> None:
        """Begin a computation; one that runs is given up.

        Args:
            steps: It yields after every step, and keeps its result itself.
        """
        self._steps = steps

    def cancel(self) -> None:
        """Give up a computation that runs."""
        self._steps = None

    def advance(self, count: int) -> None:
        """Do some steps.

        Args:
            count: At most so many.
        """
        for _ in range(count):
            if self._steps is None:
                return
            try:
                next(self._steps)
            except StopIteration:
                self._steps = None

    def finish(self) -> None:
        """Do all steps that are left."""
        while self.is_running:
            self.advance(1)
