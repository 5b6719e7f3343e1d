# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Tables of how time grows with size."""

from __future__ import annotations

from typing import Any

from benchmarks.report.table import number, table


def growth_section(results: dict[str, Any]) -> str:
    """Time against voxel size, resolution, region, surface and views.

    Args:
        results: Result of :func:`benchmarks.run.run`.
    """
    fusion, estimates = results["growth_of_fusion"], results["growth_of_estimates"]
    rows = [[f"{one['voxel_size_mm']:g} mm voxels", *_fused(one)] for one in fusion["voxel_size"]]
    rows += [[f"{o['width']} x {o['height']} pixels", *_fused(o)] for o in fusion["resolution"]]
    rows += [[f"region: {one['region']}", *_fused(one)] for one in fusion["region"]]
    text = table(("frame, each a new view", "p50 ms", "p95 ms", "voxels", "observations"), rows)
    names = [one["name"] for one in estimates["store"][0]["timings"]]
    measured = (*estimates["store"], *estimates["views"])
    rows = [
        [
            f"{one['voxels']:,} voxels, {one['views']} views",
            f"{one['observations']:,}",
            number(one["added_mb"]),
            *(number(timing["p50_ms"]) for timing in one["timings"]),
        ]
        for one in measured
    ]
    return text + "\n" + table(("scan (p50 ms)", "observations", "adds MB", *names), rows)


def _fused(one: dict[str, Any]) -> list[str]:
    fuse = one["fuse"]
    return [
        number(fuse["p50_ms"]),
        number(fuse["p95_ms"]),
        f"{one['voxels']:,}",
        f"{one['observations']:,}",
    ]
