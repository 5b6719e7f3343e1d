# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Markdown tables of numbers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table whose first column is text and whose others are numbers.

    Args:
        header: Names of the columns.
        rows: Cells as text.
    """
    lines = [_line(header), _line(["---", *["---:"] * (len(header) - 1)])]
    return "\n".join([*lines, *(_line(row) for row in rows)]) + "\n"


def number(value: float | None) -> str:
    """A number with at least three significant digits; whole from 100 on; a dash for None.

    Args:
        value: The number.
    """
    if value is None:
        return "-"
    if value >= 100.0:
        return f"{value:,.0f}"
    return f"{value:.1f}" if value >= 10.0 else f"{value:.2f}"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"
