# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Counters and warnings of a scan over time, for the diagnostics."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Hashable, Mapping
from typing import Generic, TypeVar

from rclpy.node import Node

from reflest_core.estimation.pipeline import Pipeline
from reflest_ros.workers.fusion_counts import FusionCounts

Key = TypeVar("Key", bound=Hashable)

NEARLY_FULL = 0.85
"""Room is made by an eighth at a time, so that a store at its budget stays above this."""

WORTH_A_WARNING = 0.5
"""Stops."""


class RecentCounts(Generic[Key]):
    """Remembers samples of growing counters."""

    def __init__(self, window: float) -> None:
        """Begin without a sample.

        Args:
            window: Seconds that are remembered.
        """
        self._window = window
        self._samples: deque[tuple[float, dict[Key, int]]] = deque()

    def sample(self, now: float, counts: Mapping[Key, int]) -> None:
        """Note the counters.

        Args:
            now: Seconds since any time.
            counts: The counters at that time.
        """
        self._samples.append((now, dict(counts)))
        while len(self._samples) > 2 and now - self._samples[1][0] >= self._window:
            self._samples.popleft()

    def increase(self, key: Key) -> int:
        """Return by how much a counter grew within the window; a new one began at 0.

        Args:
            key: Of the counter.

        Returns:
            The difference; 0 before the first sample.
        """
        if not self._samples:
            return 0
        (_, oldest), (_, newest) = self._samples[0], self._samples[-1]
        return newest.get(key, 0) - oldest.get(key, 0)

    def rate(self, key: Key) -> float:
        """Return how fast a counter grew within the window.

        Args:
            key: Of the counter.

        Returns:
            Counts each second; 0 before the second sample.
        """
        if len(self._samples) < 2:
            return 0.0
        elapsed = self._samples[-1][0] - self._samples[0][0]
        return self.increase(key) / elapsed if elapsed > 0 else 0.0


class ScanWarnings:
    """Warns of what goes wrong slowly: a store that fills up, an exposure that changes."""

    def __init__(self, node: Node, scanner: Pipeline) -> None:
        """Begin to watch a scan.

        Args:
            node: Logs each kind of warning once.
            scanner: The scan.
        """
        self._log = node.get_logger()
        self._scanner = scanner
        self._logged: set[str] = set()

    def check(self, counts: FusionCounts) -> list[str]:
        """Look at the scan; log a kind of warning the first time.

        Args:
            counts: Of the fusion thread.

        Returns:
            A sentence for each warning that applies now.
        """
        now = {"store_full": self._fullness(counts), "exposure_drift": _exposure(counts)}
        for kind, sentence in now.items():
            if sentence and kind not in self._logged:
                self._logged.add(kind)
                self._log.warning(f"{sentence} (cause: {kind}; logged once)")
        return [sentence for sentence in now.values() if sentence]

    def _fullness(self, counts: FusionCounts) -> str:
        if counts.fill < NEARLY_FULL:
            return ""
        budget_mb = self._scanner.scan.fusion.memory_budget_mb
        return (
            f"the store has filled {counts.fill:.0%} of its budget of {budget_mb:g} MB, and "
            "new voxels replace those unseen for longest: raise fusion.memory_budget_mb or "
            "fusion.voxel_size, or set a region of interest"
        )


def _exposure(counts: FusionCounts) -> str:
    drift = counts.exposure_drift
    if not abs(drift) > WORTH_A_WARNING:
        return ""
    return (
        f"foreground and background have become {abs(drift):.1f} stops "
        f"{'brighter' if drift > 0 else 'darker'} in mid-scan, of which "
        f"{abs(math.log2(counts.exposure_gain)):.1f} are seen in the background and "
        "corrected: lock the camera's exposure and white balance, or keep the light constant"
    )
