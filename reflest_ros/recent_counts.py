# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What counters did of late."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable, Mapping
from typing import Generic, TypeVar

Key = TypeVar("Key", bound=Hashable)


class RecentCounts(Generic[Key]):
    """Remembers samples of growing counters over the last ``window`` seconds."""

    def __init__(self, window: float) -> None:
        self._window = window
        self._samples: deque[tuple[float, dict[Key, int]]] = deque()

    def sample(self, now: float, counts: Mapping[Key, int]) -> None:
        """Note the counters as they stand at ``now`` (seconds, any zero)."""
        self._samples.append((now, dict(counts)))
        while len(self._samples) > 2 and now - self._samples[1][0] >= self._window:
            self._samples.popleft()

    def increase(self, key: Key) -> int:
        """By how much a counter grew within the window; one that is new began at 0."""
        if not self._samples:
            return 0
        (_, oldest), (_, newest) = self._samples[0], self._samples[-1]
        return newest.get(key, 0) - oldest.get(key, 0)

    def rate(self, key: Key) -> float:
        """Growth per second within the window; 0 before the second sample."""
        if len(self._samples) < 2:
            return 0.0
        elapsed = self._samples[-1][0] - self._samples[0][0]
        return self.increase(key) / elapsed if elapsed > 0 else 0.0
