# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Sections: the stages of the live path, the peer, and the models."""

from __future__ import annotations

from typing import Any

from benchmarks.measurements.stages import (
    ASSEMBLE,
    ESTIMATE,
    FRAME,
    FROM_STORE,
    FUSE,
    FUSE_DEPTH,
    FUSE_KNOWN,
    FUSE_NEW,
    FUSE_REDUNDANT,
    NETWORK,
    PUBLISH,
    SHIPPED_KIND,
    SNAPSHOT,
)
from benchmarks.report.table import number, table

WHOLES = (ASSEMBLE, FUSE, FRAME, ESTIMATE, FROM_STORE)
"""Sums of the stages above them; in bold."""
ORDER = (
    "match",
    "decode",
    ASSEMBLE,
    "classify pixels",
    "F and B",
    "redundancy",
    "TSDF",
    "background light",
    "observations",
    SNAPSHOT,
    FUSE_NEW,
    FUSE_KNOWN,
    FUSE_DEPTH,
    FUSE_REDUNDANT,
    FUSE,
    FRAME,
    "voxel choice",
    "hemisphere images",
    "grouplets",
    "shading",
    NETWORK,
    "coverage",
    ESTIMATE,
    FROM_STORE,
    PUBLISH,
)
PERCENTILES = ("p50_ms", "p95_ms", "p99_ms")
COMPARED = ("fuse_ms", "open3d_ms", "ratio")


def stages_section(results: dict[str, Any]) -> str:
    """Section: every stage of the live path, for each number of threads.

    Args:
        results: Result of :func:`benchmarks.run.run`.
    """
    runs = results["frame_path"]
    by_name = {key: {one["name"]: one for one in run["stages"]} for key, run in runs.items()}
    first = next(iter(runs))
    header = ["stage", "runs", "adds MB"]
    for key in runs:
        header += [f"p50, {_threads(key)}", "p95", "p99"]
    rows = []
    for name in sorted(by_name[first], key=_place):
        one = by_name[first][name]
        row = [f"**{name}**" if name in WHOLES else name, str(one["count"])]
        row.append(number(one["memory_mb"]))
        for timings in by_name.values():
            row += [number(timings[name][p]) if name in timings else "-" for p in PERCENTILES]
        rows.append(row)
    peaks = ", ".join(f"{run['peak_mb']:,.0f} MB with {_threads(key)}" for key, run in runs.items())
    run = runs[first]
    return (
        table(header, rows)
        + f"\nMilliseconds. {run['frames']} frames gave {run['voxels']:,} voxels, "
        f"{run['observations']:,} observations, {run['views']} views. Peak resident memory of the "
        f"whole process, libraries included: {peaks}.\n"
    )


def open3d_section(results: dict[str, Any]) -> str:
    """Section: Open3D in the same run.

    Args:
        results: Result of :func:`benchmarks.run.run`.
    """
    rows = []
    for key, compared in results["against_open3d"].items():
        for kind, one in compared.items():
            rows.append(
                [f"{kind}, {_threads(key)}", str(one["frames"])]
                + [number(one[p][f]) for p in ("p50", "p95") for f in COMPARED]
            )
    header = ["Open3D", "frames", "p50 reflest", "p50 Open3D", "ratio"]
    text = table([*header, "p95 reflest", "p95 Open3D", "ratio"], rows)
    rows = [
        [f"{kind}, {_threads(key)}: {one['name']}", *(number(one[p]) for p in PERCENTILES)]
        for key, peers in results["open3d"].items()
        for kind, peer in peers.items()
        for one in peer["stages"]
    ]
    return text + "\n" + table(("Open3D, all it does", "p50", "p95", "p99"), rows)


def estimation_section(results: dict[str, Any]) -> str:
    """Section: every model, stage by stage, and PyTorch on the same inputs.

    Args:
        results: Result of :func:`benchmarks.run.run`.
    """
    rows = []
    for key, run in results["estimation"].items():
        for model, kinds in run["models"].items():
            for kind, timings in kinds.items():
                for one in sorted(timings, key=lambda one: _place(one["name"])):
                    name = f"**{one['name']}**" if one["name"] in WHOLES else one["name"]
                    peer = "" if kind == SHIPPED_KIND else f", {kind}"
                    row = [f"{model}, {_threads(key)}: {name}{peer}"]
                    row += [str(one["count"]), *(number(one[p]) for p in PERCENTILES)]
                    rows.append([*row, number(one["memory_mb"])])
    return table(("model and stage", "runs", "p50", "p95", "p99", "adds MB"), rows)


def _threads(key: str) -> str:
    return "1 thread" if key == "1" else f"{key} threads"


def _place(name: str) -> int:
    return ORDER.index(name) if name in ORDER else len(ORDER)
