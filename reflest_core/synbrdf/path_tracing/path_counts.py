# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How many paths a ray may have: Mitsuba's sampler stratifies them over a grid."""

from __future__ import annotations

import math

from reflest_core.errors import ReflestError


class PathCountError(ReflestError):
    """A number of paths that cannot be stratified."""


def check_paths(paths: int, rays: int = 1) -> None:
    """Refuse a number of paths that fills no grid of nearly as many rows as columns.

    Args:
        paths: Of a pixel or an observation, at least ``rays``.
        rays: Rays that share them evenly.

    Raises:
        PathCountError: The numbers below and above it that fill one are named.
    """
    of_ray = paths // rays
    if _fills_grid(of_ray):
        return
    below, above = of_ray, of_ray
    while not _fills_grid(below):
        below -= 1
    while not _fills_grid(above):
        above += 1
    raise PathCountError(
        f"--samples is {paths}, which cannot be stratified over a grid: "
        f"choose {below * rays} or {above * rays}"
    )


def _fills_grid(paths: int) -> bool:
    """As ``multijitter`` lays them out: as many rows as the square root, rounded down."""
    rows = math.isqrt(paths)
    return rows * math.ceil(paths / rows) == paths
