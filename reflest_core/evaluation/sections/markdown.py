# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Tables and numbers as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

Record = dict[str, Any]
Lines = list[str]


def interval(found: Record) -> str:
    """A bootstrap interval as text.

    Args:
        found: ``low`` and ``high``.
    """
    return f"{found['low']:.3f} to {found['high']:.3f}"


def percent(share: float) -> str:
    """A share as whole per cent.

    Args:
        share: In [0, 1].
    """
    return f"{100 * share:.0f} %"


def spread(rmse: Record) -> list[float]:
    """Mean, median and 95th percentile over scenes of a scene's own error.

    Args:
        rmse: A :class:`NormalisedRmse` as a record.
    """
    return [rmse["scene_mean"], rmse["scene_median"], rmse["scene_p95"]]


def table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    """Lines of a Markdown table.

    Args:
        header: Names of the columns.
        rows: Cells; floats get three decimals, None gives an empty cell.
    """
    lines = ["| " + " | ".join(header) + " |", "|---" * len(header) + "|"]
    lines += ["| " + " | ".join(map(_cell, row)) + " |" for row in rows]
    return lines


def _cell(value: object) -> str:
    if value is None:
        return ""
    return f"{value:.3f}" if isinstance(value, float) else str(value)
