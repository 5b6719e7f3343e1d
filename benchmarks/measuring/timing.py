# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Many durations of one thing as the few numbers that are published."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Timing:
    """Percentiles in milliseconds over ``count`` runs.

    ``memory_mb``: the most that one run added to the resident memory at its peak, 10^6 bytes; None
    where that was not measured.
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
        """Of at least one duration."""
        ms = 1000.0 * np.asarray(seconds, np.float64)
        p50, p95, p99 = (float(value) for value in np.percentile(ms, [50, 95, 99]))
        return cls(name, len(ms), p50, p95, p99, float(ms.mean()), memory_mb)
