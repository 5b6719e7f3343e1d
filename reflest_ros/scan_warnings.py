# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What goes wrong slowly in a scan: a store that fills up, an exposure that changes."""

from __future__ import annotations

import math

from rclpy.node import Node

from reflest_core.estimation.scanner import Scanner
from reflest_ros.workers.fusion_counts import FusionCounts

NEARLY_FULL = 0.85
"""Room is made by an eighth at a time, so that a store at its budget stays above this."""

WORTH_A_WARNING = 0.5
"""Stops."""


class ScanWarnings:
    """Logs each kind of trouble once, and says on every check what holds now."""

    def __init__(self, node: Node, scanner: Scanner) -> None:
        self._log = node.get_logger()
        self._scanner = scanner
        self._said: set[str] = set()

    def check(self, counts: FusionCounts) -> list[str]:
        """Sentences about the scan as it is now."""
        now = {"store_full": self._fullness(counts), "exposure_drift": _exposure(counts)}
        for kind, sentence in now.items():
            if sentence and kind not in self._said:
                self._said.add(kind)
                self._log.warning(f"{sentence} (cause: {kind}; said once)")
        return [sentence for sentence in now.values() if sentence]

    def _fullness(self, counts: FusionCounts) -> str:
        if counts.fill < NEARLY_FULL:
            return ""
        budget_mb = self._scanner.scan.fusion.memory_budget_mb
        return (
            f"the store has filled {counts.fill:.0%} of its budget of {budget_mb:g} MB, and "
            "voxels unseen for longest give way to new ones: raise fusion.memory_budget_mb or "
            "fusion.voxel_size, or set a region of interest"
        )


def _exposure(counts: FusionCounts) -> str:
    drift = counts.exposure_drift
    if not abs(drift) > WORTH_A_WARNING:
        return ""
    return (
        f"foreground and background have become {abs(drift):.1f} stops "
        f"{'brighter' if drift > 0 else 'darker'} in mid-scan, of which the background tells "
        f"{abs(math.log2(counts.exposure_gain)):.1f}, which is corrected: lock the camera's "
        "exposure and white balance, or see that the light stays as it is"
    )
