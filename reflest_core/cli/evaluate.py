# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest evaluate``: the paper's tables and figures, measured with the shipped weights."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from reflest_core.cli.parser import check_source
from reflest_core.parameter import ParameterError

ALL_PARTS = (
    "table-2",
    "views",
    "look-around",
    "calibration",
    "held-out-lights",
    "failures",
    "ablation",
    "realism",
    "realism-training",
    "stability",
    "latency",
    "eight-bit",
    "baselines",
    "perception",
    "materials",
    "quick",
)

OPTIMISED = 8
"""Scenes of each split for the slow baseline, about ten seconds each on an idle core."""


def add_parser(subparsers: Any) -> None:
    """Add the subcommand.

    Args:
        subparsers: What :meth:`argparse.ArgumentParser.add_subparsers` returned.
    """
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "evaluate", help="measure the networks on SynBRDF: tables, plots and pictures"
    )
    parser.add_argument(
        "data",
        type=Path,
        nargs="?",
        help="folder written by 'reflest synbrdf generate'; for the parts "
        "stability and materials: of captures",
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help="reproduce one row of Table 2 from what is shipped; needs no data",
    )
    parser.add_argument("--out", type=Path, help="folder for records, page, plots and pictures")
    parser.add_argument(
        "--parts",
        nargs="*",
        choices=ALL_PARTS,
        metavar="PART",
        help=f"which to measure, of {', '.join(ALL_PARTS)}; none: write the page alone; default: "
        "all, but ablation only with --ablation, realism-training with --unhardened, look-around "
        "with --environments, held-out-lights with --held-out, stability (of "
        "captures) and materials (of bags of 'reflest synbrdf tabletop') where they are named",
    )
    parser.add_argument(
        "--runs", type=Path, help="folder of trained variants; default: the shipped weights"
    )
    parser.add_argument(
        "--environments", type=Path, help="the data set's, to render materials under unseen ones"
    )
    parser.add_argument(
        "--meshes", type=Path, help="the data set's, to render badly estimated scenes from nearby"
    )
    parser.add_argument("--limit", type=int, help="only the first so many scenes of each split")
    parser.add_argument(
        "--optimised",
        type=int,
        default=OPTIMISED,
        help=f"scenes of each split that the slow baseline gets; default: {OPTIMISED}",
    )
    parser.add_argument(
        "--ablation",
        type=Path,
        metavar="FOLDER",
        help="trainings of lightnet with --hold-out, with and without --without",
    )
    parser.add_argument(
        "--unhardened",
        type=Path,
        metavar="FOLDER",
        help="variants trained without --realism, to compare with those of --runs",
    )
    parser.add_argument(
        "--held-out",
        type=Path,
        nargs="+",
        metavar="RUN",
        default=[],
        help="trainings of lightnet, each with --hold-out and other environments",
    )
    parser.add_argument(
        "--compare",
        type=Path,
        nargs=2,
        metavar=("FOUND.ply", "TRUTH.ply"),
        help="print the errors of what 'reflest replay --materials' wrote; needs no data",
    )
    parser.add_argument(
        "--realism", nargs="*", metavar="EFFECT", help="give scenes the faults of a real capture"
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Measure the parts, one after another, and write the page.

    Args:
        arguments: The parsed command line.

    Returns:
        The exit status.

    Raises:
        SourceMissing: DATA does not exist.
        ParameterError: neither DATA and ``--out`` nor ``--quick`` nor ``--compare`` is given.
    """
    if arguments.quick:
        return _run_quick()
    if arguments.compare is not None:
        return _run_compare(*arguments.compare)
    if arguments.data is not None:
        check_source(arguments.data)
    if arguments.data is None or arguments.out is None:
        raise ParameterError("reflest evaluate needs DATA and --out, or --quick, or --compare")
    from reflest_core.evaluation.page import write_page
    from reflest_core.evaluation.parts import run_part
    from reflest_core.evaluation.studies.study import Study, StudySettings

    settings = StudySettings(
        arguments.data,
        arguments.out,
        _command(arguments),
        arguments.runs,
        arguments.environments,
        arguments.limit,
        arguments.optimised,
        _degradation(arguments),
        arguments.ablation,
        arguments.meshes,
        arguments.unhardened,
        tuple(arguments.held_out),
    )
    study = Study(settings)
    wanted = _wanted(arguments)
    for part in ALL_PARTS:
        if part in wanted:
            print(f"measuring {part}", flush=True)
            run_part(study, part)
    print(write_page(arguments.out))
    return 0


def _wanted(arguments: argparse.Namespace) -> list[str]:
    if arguments.parts is not None:
        return list(arguments.parts)
    given = {
        "ablation": arguments.ablation,
        "realism-training": arguments.unhardened,
        "look-around": arguments.environments,
        "held-out-lights": arguments.held_out,
        "materials": False,
        "stability": False,
    }
    return [part for part in ALL_PARTS if given.get(part, True)]


def _run_quick() -> int:
    from reflest_core.evaluation.quick_check import reproduce_row

    row = reproduce_row()
    measured = row.accuracy.ward
    print(
        f"{row.title}, {row.accuracy.scenes} validation scenes: normalised RMSE "
        f"{measured.overall:.3f} (Table 2: {row.recorded:.3f}), scene mean "
        f"{measured.scene_mean:.3f}, median {measured.scene_median:.3f}, p95 "
        f"{measured.scene_p95:.3f}"
    )
    return 0


def _run_compare(found: Path, truth: Path) -> int:
    from reflest_core.evaluation.statistics.material_clouds import (
        compare_clouds,
        read_cloud,
        report,
    )

    print("\n".join(report(compare_clouds(read_cloud(found), read_cloud(truth)))))
    return 0


def _command(arguments: argparse.Namespace) -> str:
    """The command without this machine's folders."""
    words = ["reflest evaluate DATA --out docs/results"]
    if arguments.runs:
        words.append("--runs RUNS")
    if arguments.ablation:
        words.append("--ablation ABLATION")
    if arguments.unhardened:
        words.append("--unhardened UNHARDENED")
    if arguments.held_out:
        words.append("--held-out RUN...")
    if arguments.environments:
        words.append("--environments ENVIRONMENTS")
    if arguments.meshes:
        words.append("--meshes MESHES")
    if arguments.optimised != OPTIMISED:
        words.append(f"--optimised {arguments.optimised}")
    if arguments.limit:
        words.append(f"--limit {arguments.limit}")
    if arguments.realism is not None:
        words.append(" ".join(["--realism", *arguments.realism]))
    return " ".join(words)


def _degradation(arguments: argparse.Namespace) -> Any:
    if arguments.realism is None:
        return None
    from reflest_core.synbrdf.realism.settings import Realism, parse_effects
    from reflest_core.training.data.sample import Degradation

    return Degradation(Realism.only(parse_effects(arguments.realism or ["all"])), seed=1)
