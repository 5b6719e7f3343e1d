"""The page's sections, each a function of the results."""

from __future__ import annotations

from typing import Any

from benchmarks.measurements.stages import ASSEMBLE, ESTIMATE, FRAME, FUSE
from benchmarks.report.table import number, table
from benchmarks.report.targets import targets

WHOLES = (ASSEMBLE, FUSE, FRAME, ESTIMATE)
"""Sums of the stages above them; in bold."""
ORDER = (
    "match", "decode", ASSEMBLE, "classify pixels", "TSDF", "F and B", "observations", "snapshot",
    FUSE, FRAME, "voxel choice", "hemisphere images", "grouplets", "network", "coverage", ESTIMATE,
    "publish",
)  # fmt: skip


def machine_section(results: dict[str, Any]) -> str:
    """Where and with what it was measured."""
    machine = results["machine"]
    libraries = ", ".join(f"{name} {version}" for name, version in machine["libraries"].items())
    return (
        f"{machine['cpu']}, {machine['cores']} cores, {machine['memory_gb']:g} GB, "
        f"{machine['system']}, Python {machine['python']}; {libraries}. "
        f"Commit {machine['commit']}. Load average at the start {machine['load_at_start']:g}; "
        f"the run took {results['took_s'] / 60:.0f} minutes.\n"
    )


def targets_section(results: dict[str, Any]) -> str:
    """Promise against measurement."""
    rows = [
        (one.what, f"{number(one.limit)} {one.unit}", number(one.measured), _yes(one.is_met))
        for one in targets(results)
    ]
    return table(("target", "at most", "measured", "met"), rows)


def stages_section(results: dict[str, Any]) -> str:
    """Every stage of the live path, for each number of threads."""
    runs = results["frame_path"]
    by_name = {key: {one["name"]: one for one in run["stages"]} for key, run in runs.items()}
    first = next(iter(runs))
    header = ["stage", "runs", "adds MB"]
    for key in runs:
        header += [f"p50, {key} thr.", "p95", "p99"]
    rows = []
    for name in sorted(by_name[first], key=_place):
        one = by_name[first][name]
        row = [f"**{name}**" if name in WHOLES else name, str(one["count"])]
        row.append(number(one["memory_mb"]))
        for timings in by_name.values():
            row += [number(timings[name][p]) if name in timings else "-" for p in PERCENTILES]
        rows.append(row)
    peaks = ", ".join(f"{run['peak_mb']:,.0f} MB with {key} thread(s)" for key, run in runs.items())
    run = runs[first]
    return (
        table(header, rows)
        + f"\nMilliseconds. {run['frames']} frames gave {run['voxels']:,} voxels, "
        f"{run['observations']:,} observations, {run['views']} views. Peak resident memory of the "
        f"whole process, libraries included: {peaks}.\n"
    )


def open3d_section(results: dict[str, Any]) -> str:
    """The peer in the same run."""
    rows = []
    for key, compared in results["against_open3d"].items():
        for kind, one in compared.items():
            rows.append(
                [f"{kind}, {key} thread(s)", str(one["frames"])]
                + [number(one[p][f]) for p in ("p50", "p95") for f in COMPARED]
            )
    header = ["Open3D", "frames", "p50 ours", "p50 Open3D", "ratio"]
    text = table([*header, "p95 ours", "p95 Open3D", "ratio"], rows)
    rows = [
        [f"{kind}, {key} thread(s): {one['name']}", *(number(one[p]) for p in PERCENTILES)]
        for key, peers in results["open3d"].items()
        for kind, peer in peers.items()
        for one in peer["stages"]
    ]
    return text + "\n" + table(("Open3D, all it does", "p50", "p95", "p99"), rows)


def estimation_section(results: dict[str, Any]) -> str:
    """Every model, stage by stage, and PyTorch's eager mode on the same inputs."""
    rows = []
    for key, run in results["estimation"].items():
        for model, kinds in run["models"].items():
            for kind, timings in kinds.items():
                for one in sorted(timings, key=lambda one: _place(one["name"])):
                    name = f"**{one['name']}**" if one["name"] in WHOLES else one["name"]
                    row = [f"{model}, {key} thr.: {name}" + (", PyTorch eager" * (kind == "eager"))]
                    row += [str(one["count"]), *(number(one[p]) for p in PERCENTILES)]
                    rows.append([*row, number(one["memory_mb"])])
    return table(("model and stage", "runs", "p50", "p95", "p99", "adds MB"), rows)


def growth_section(results: dict[str, Any]) -> str:
    """Cost against voxel size, resolution, region, surface and views."""
    fusion, estimates = results["growth_of_fusion"], results["growth_of_estimates"]
    rows = [[f"{one['voxel_size_mm']:g} mm voxels", *_fused(one)] for one in fusion["voxel_size"]]
    rows += [[f"{o['width']} x {o['height']} pixels", *_fused(o)] for o in fusion["resolution"]]
    rows += [[f"region: {one['region']}", *_fused(one)] for one in fusion["region"]]
    text = table(("frame, each a new view", "p50 ms", "p95 ms", "voxels", "observations"), rows)
    names = [one["name"] for one in estimates["store"][0]["timings"]]
    rows = [
        [
            f"{one['voxels']:,} voxels, {one['views']} views",
            f"{one['observations']:,}",
            *(number(timing["p50_ms"]) for timing in one["timings"]),
        ]
        for one in (*estimates["store"], *estimates["views"])
    ]
    return text + "\n" + table(("scan (p50 ms)", "observations", *names), rows)


def live_section(results: dict[str, Any]) -> str:
    """The bag to the node."""
    live = results["live"]
    lost = ", ".join(f"{cause}: {count}" for cause, count in live["lost_to_overload"].items())
    refused = ", ".join(f"{cause}: {count}" for cause, count in live["refused"].items())
    latency = live["latency"] or {}
    rows = [
        ["messages sent", f"{live['messages_sent']:,}"],
        ["messages received", f"{live['messages_received']:,}"],
        ["frames matched", f"{live['frames_matched']:,}"],
        ["frames fused", f"{live['frames_fused']:,}"],
        ["frames skipped as redundant", f"{live['frames_redundant']:,}"],
        ["lost to overload", lost],
        ["refused for other reasons", refused or "0"],
        ["keyframes", str(live["keyframes"])],
        ["keyframes skipped for a newer one", str(live["keyframes_skipped"])],
        ["estimates", str(live["estimates"])],
        *([f"estimate latency {p[:3]}", f"{number(latency.get(p))} ms"] for p in PERCENTILES),
        ["peak resident memory of the node", f"{live['peak_mb']:,.0f} MB"],
        ["cores that the node kept busy", number(live["cores_used"])],
        ["node's start to subscribed", f"{live['start_up_s']:.1f} s"],
    ]
    return table((f"{live['seconds']:g} s, {live['frames_played']:,} frames", ""), rows)


def start_up_section(results: dict[str, Any]) -> str:
    """Start-up phases and replay speed."""
    rows = [[one["name"], number(one["p50_ms"])] for one in results["start_up"]["phases"]]
    replay = results["replay"]
    return (
        table(("start-up", "p50 ms"), rows)
        + f"\n`reflest replay` of {replay['filmed_s']:g} s of VGA took {replay['wall_s']:.1f} s, "
        f"its start included: {replay['times_real_time']:.1f} times real time, "
        f"{replay['estimates']} estimates, {replay['peak_mb']:,.0f} MB at its peak.\n"
    )


PERCENTILES = ("p50_ms", "p95_ms", "p99_ms")
COMPARED = ("fuse_ms", "open3d_ms", "ratio")


def _place(name: str) -> int:
    return ORDER.index(name) if name in ORDER else len(ORDER)


def _fused(one: dict[str, Any]) -> list[str]:
    fuse = one["fuse"]
    return [
        number(fuse["p50_ms"]), number(fuse["p95_ms"]),
        f"{one['voxels']:,}", f"{one['observations']:,}",
    ]  # fmt: skip


def _yes(is_met: bool) -> str:
    return "yes" if is_met else "**no**"
