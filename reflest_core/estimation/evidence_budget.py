# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Less evidence where estimates take longer than they may: for slow and busy computers.

The share that is used follows the measured time, so that estimates with a budget differ from run to
run and from those of a replay.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

LEAST = 0.25
"""Share of the evidence that is always used: an estimate then takes about 0.8 of the usual time."""
SPARE = 0.8
"""Share of the budget below which more evidence is used again."""
GROWTH = 1.25
"""By at most this factor from one estimate to the next."""


class EvidenceBudget:
    """The share of the evidence with which estimates keep within a time.

    Attributes:
        seconds: Of an estimate; 0 for no limit.
        share: In (0, 1]; 1 before the first estimate and where there is no limit.
    """

    def __init__(self, seconds: float, clock: Callable[[], float] = time.perf_counter) -> None:
        """Begin with all of the evidence.

        Args:
            seconds: Of an estimate; 0 for no limit.
            clock: Returns seconds.
        """
        self.seconds, self.share, self._clock = seconds, 1.0, clock

    @property
    def note(self) -> str:
        """What is left out, as a sentence, or ""."""
        if self.share == 1.0:
            return ""
        return (
            f"{self.share:.0%} of the evidence was used, to keep within estimation.budget = "
            f"{self.seconds:g} s"
        )

    @contextmanager
    def spending(self) -> Iterator[None]:
        """Time an estimate; the next one uses the share that would have fitted.

        Yields:
            Once, to make the estimate.
        """
        started = self._clock()
        yield
        taken = self._clock() - started
        if self.seconds == 0.0:
            return
        if taken > self.seconds:
            self.share = max(self.share * self.seconds / taken, LEAST)
        elif taken < SPARE * self.seconds:
            self.share = min(self.share * GROWTH, 1.0)
