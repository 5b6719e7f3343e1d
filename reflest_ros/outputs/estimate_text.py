# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""An estimate in a few short lines, for a display."""

from __future__ import annotations

import math

from reflest_core.estimation.estimate import BrdfEstimate, EstimateStatus


def estimate_text(estimate: BrdfEstimate | None) -> str:
    """Values, deviations where they are known, and how far to trust them."""
    if estimate is None:
        return "no estimate yet: scan more of the object"
    red, green, blue = estimate.rho_d
    lines = [
        f"rho_d  {red:.3f} {green:.3f} {blue:.3f}{_deviation(max(estimate.rho_d_stddev))}",
        f"rho_s  {estimate.rho_s:.3f}{_deviation(estimate.rho_s_stddev)}",
        f"alpha  {estimate.alpha:.3f}{_deviation(estimate.alpha_stddev)}",
        f"{estimate.coverage:.0%} of directions, {estimate.view_count} views",
    ]
    if estimate.status is not EstimateStatus.OK:
        lines += f"{estimate.status.name}: {estimate.status_text}".split("; ")
    return "\n".join(lines)


def _deviation(stddev: float) -> str:
    return "" if math.isnan(stddev) else f" ± {stddev:.3f}"
