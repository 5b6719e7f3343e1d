# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sections: size, time, 8-bit weights, fewer voxels, and the quick check."""

from __future__ import annotations

from reflest_core.evaluation.sections.markdown import Lines, Record, table


def latency(record: Record) -> Lines:
    """Section: size of the weights and time of an estimate.

    Args:
        record: Result of :func:`.measure_latency`.
    """
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
    """Section: the error that 8-bit weights add.

    Args:
        record: Result of :func:`.measure_eight_bit`.
    """
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
        "## 8-bit weights",
        "",
        f"RMSE on {record['scenes']} validation scenes drawn by seed. Grouplet ships in 8 bits",
        "(in float32 it misses the paper's 340 KB), HemiCNN and lightnet in float32. A variant is",
        "left out where its float32 weights were not kept.",
        "",
        *table(header, body),
        "",
    ]


def quick(record: Record) -> Lines:
    """Section: the row of Table 2 that ``--quick`` reproduces.

    Args:
        record: Result of :func:`.write_expected`.
    """
    return [
        "## Reproducing one row",
        "",
        "`reflest evaluate --quick` estimates all validation scenes again from a shipped file of",
        f"{record['bytes'] / 1e6:.1f} MB with the voxels that HemiCNN uses. It fails unless",
        f"{record['variant']} has RMSE {record['rmse']:.4f} again on {record['scenes']} scenes.",
        "",
    ]
