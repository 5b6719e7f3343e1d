# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Size, time, and what fewer bits or fewer voxels cost; and the row that anyone can repeat."""

from __future__ import annotations

from reflest_core.evaluation.sections.cells import Lines, Record, interval
from reflest_core.evaluation.sections.markdown import table


def latency(record: Record) -> Lines:
    """Size and time."""
    header = ["model", "bytes", "paper", "median ms", "p95 ms", "paper"]
    body = [
        [
            row["model"],
            row["bytes"],
            row["paper_bytes"],
            f"{row['median_ms']:.1f}",
            f"{row['p95_ms']:.1f}",
            None if row["paper_ms"] is None else f"{row['paper_ms']:.0f}",
        ]
        for row in record["rows"]
    ]
    return [
        "## Size and latency",
        "",
        "Voxel choice, features and network for a SynBRDF scene with all its views, on",
        f"{record['machine']}; the paper does not name its machine.",
        "",
        *table(header, body),
        "",
    ]


def eight_bit(record: Record) -> Lines:
    """What quantisation costs."""
    header = ["variant", "float32", "8-bit", "difference", "float32 bytes", "8-bit bytes"]
    body = [
        [
            row["title"],
            f"{row['float32']:.4f}",
            f"{row['eight_bit']:.4f}",
            f"{row['eight_bit'] - row['float32']:+.4f}",
            row["float32_bytes"],
            row["eight_bit_bytes"],
        ]
        for row in record["rows"]
    ]
    return [
        "## What 8-bit weights cost",
        "",
        f"RMSE on {record['scenes']} validation scenes drawn by seed. Grouplet ships in 8 bits",
        "(in float32 it misses the paper's 340 KB), HemiCNN and lightnet in float32. A variant is",
        "left out where its float32 weights were not kept.",
        "",
        *table(header, body),
        "",
    ]


def quick(record: Record) -> Lines:
    """The row that anyone can repeat."""
    return [
        "## One row, reproduced anywhere",
        "",
        "`reflest evaluate --quick` estimates all validation scenes again from a shipped file of",
        f"{record['bytes'] / 1e6:.1f} MB that holds the voxels HemiCNN looks at, and fails unless",
        f"{record['variant']} reaches {record['rmse']:.4f} again on {record['scenes']} scenes.",
        "",
    ]


def time_accuracy(record: Record) -> Lines:
    """Error by voxels and time."""
    body = [
        [
            point["voxels"],
            point["rmse"],
            interval(point["over_scenes"]),
            f"{point['median_ms']:.1f}",
            f"{point['p95_ms']:.1f}",
        ]
        for point in record["points"]
    ]
    return [
        "## Accuracy against time",
        "",
        "![Error against time](time-accuracy.png)",
        "",
        f"lightnet with fewer voxels than it was trained with, on {record['scenes']} validation",
        "scenes drawn by seed; the time of an estimate, features included, on one thread. Most of",
        "it goes into light and material of the scene, which rest on further voxels, as many in",
        "each case: so the curve is nearly a point.",
        "",
        *table(["voxels", "RMSE", "95 %, scenes", "median ms", "p95 ms"], body),
        "",
    ]
