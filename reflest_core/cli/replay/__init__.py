# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest replay``: a recorded capture through the estimator, with no ROS graph."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from reflest_core.cli.scan_options import add_scan_options, check_paths

EPILOG = """A capture is an .mcap (MCAP) or .db3 file, a rosbag2 directory, or a folder of TUM
RGB-D, OpenLORIS, 7-Scenes, 3RScan, ScanNet, ICL-NUIM, Replica, nerfstudio, Stray Scanner, Record3D
or the Amazon Picking Challenge. Topics are found by their types; name them where several would
fit."""


def add_parser(subparsers: Any) -> None:
    """Add the subcommand.

    Args:
        subparsers: the subcommands of ``reflest``.
    """
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "replay", help="estimate the BRDF in a recorded capture", epilog=EPILOG
    )
    parser.add_argument("capture", type=Path, metavar="CAPTURE")
    parser.add_argument("--json", type=Path, metavar="OUT", help="write all estimates as JSON")
    parser.add_argument(
        "--materials",
        type=Path,
        metavar="PLY",
        help="write every observed voxel with its material as a binary PLY",
    )
    parser.add_argument("--save-scan", type=Path, metavar="FILE", help="write volume and store")
    parser.add_argument(
        "--environment",
        type=Path,
        metavar="FILE",
        help="write the light around the object as .hdr or .exr",
    )
    parser.add_argument(
        "--report",
        type=Path,
        metavar="HTML",
        help="write photograph, model, materials, light and warnings as one page to open or mail; "
        "needs the extra asset or viewer",
    )
    add_scan_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Replay, print an estimate at every keyframe and the final one; write what was asked for.

    Args:
        options: all options of the command.

    Returns:
        The exit code.
    """
    outputs = ("json", "materials", "save_scan", "environment", "report")
    check_paths(options, outputs=outputs)
    from reflest_core.cli.replay.runner import replay

    replay(options)
    return 0
