# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Names the unit that depth was likely read in by mistake, and the parameter that changes it."""

from __future__ import annotations

NEAREST_USUAL, FARTHEST_USUAL = 0.1, 10.0
"""Median depths, metres, that depth cameras seldom exceed to either side."""
NEAREST_MEANT, FARTHEST_MEANT = 0.15, 3.0
"""Median depths, metres, that another unit has to lead to."""
MISTAKES = {
    1000.0: "millimetres read as metres",
    100.0: "centimetres read as metres",
    10.0: "tenths of a millimetre read as millimetres",
    5.0: "1/5000 m, the unit of TUM RGB-D, read as millimetres",
    1 / 5.0: "millimetres read as 1/5000 m, the unit of TUM RGB-D",
    1 / 10.0: "millimetres read as tenths of a millimetre",
    1 / 100.0: "metres read as centimetres",
    1 / 1000.0: "metres read as millimetres",
}
"""By how much each makes depth too large."""
TOLERANCE = 1e-6
CHECK = "check its unit (capture.depth_scale, Scanner's depth_scale)"
"""Where no usual mistake explains the depth that was seen."""


def mistake_of(factor: float) -> str:
    """Describe the mistake in depth's unit that a factor stands for.

    Args:
        factor: Depth as it was read, over true depth.

    Returns:
        The mistake and the parameter to change, or "" where no usual mistake has that factor.
    """
    for usual, mistake in MISTAKES.items():
        if abs(factor / usual - 1.0) < TOLERANCE:
            return f"{mistake}: {_advice(f'{1.0 / usual:g}')}"
    return ""


def unit_hint(median: float, max_depth: float) -> str:
    """Name the mistakes that would explain a median depth that cameras seldom see.

    Args:
        median: Of a frame's valid depth, metres.
        max_depth: Metres, beyond which nothing is fused.

    Returns:
        A clause, or "" where the median is usual.
    """
    if NEAREST_USUAL <= median <= min(FARTHEST_USUAL, max_depth):
        return ""
    is_large = median > NEAREST_USUAL
    likely = [
        (usual, mistake)
        for usual, mistake in MISTAKES.items()
        if (usual > 1.0) is is_large and NEAREST_MEANT <= median / usual <= FARTHEST_MEANT
    ]
    if not likely:
        return "" if NEAREST_USUAL <= median <= FARTHEST_USUAL else CHECK
    readings = ", or ".join(
        f"{mistake} (its median would be {median / usual:.3g} m)" for usual, mistake in likely
    )
    factors = " or ".join(f"{1.0 / usual:g}" for usual, _ in likely)
    side = "nearer" if is_large else "farther away"
    return f"if the surface is {side}, depth's unit is wrong: {readings}: {_advice(factors)}"


def _advice(factors: str) -> str:
    return (
        f"multiply capture.depth_scale (Scanner's depth_scale) by {factors}, or convert 32FC1 and "
        "float depth, which is in metres"
    )
