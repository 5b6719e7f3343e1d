# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What cells of several sections' tables share."""

from __future__ import annotations

from typing import Any

Record = dict[str, Any]
Lines = list[str]


def interval(found: Record) -> str:
    """A bootstrap interval of an error."""
    return f"{found['low']:.3f} to {found['high']:.3f}"


def percent(share: float) -> str:
    """A share in whole per cent."""
    return f"{100 * share:.0f} %"


def spread(rmse: Record) -> list[float]:
    """Mean, median and 95th percentile of the scenes' own errors."""
    return [rmse["scene_mean"], rmse["scene_median"], rmse["scene_p95"]]
