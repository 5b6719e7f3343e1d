# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Durations reduced to the numbers that are published."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Timing:
    """Percentiles over many runs of one stage.

    Attributes:
        name: Of the stage.
        count: Number of runs.
        p50_ms: Median, milliseconds.
        p95_ms: 95th percentile, milliseconds.
        p99_ms: 99th percentile, milliseconds.
        mean_ms: Milliseconds.
        memory_mb: The most that one run added to the resident memory's peak, 10^6 bytes; None
            where it was not measured.
    """

    name: str
    count: int
    p50_ms: float
    p95_ms: float
    p99_ms: float
    mean_ms: float
    memory_mb: float | None = None

    @classmethod
    def of(cls, name: str, seconds: Sequence[float], memory_mb: float | None = None) -> Timing:
        """Reduce durations.

        Args:
            name: Of the stage.
            seconds: At least one duration.
            memory_mb: See the attribute.
        """
        ms = 1000.0 * np.asarray(seconds, np.float64)
        p50, p95, p99 = (float(value) for value in np.percentile(ms, [50, 95, 99]))
        return cls(name, len(ms), p50, p95, p99, float(ms.mean()), memory_mb)
