# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest replay``: a recorded capture through the estimator, with no ROS graph."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from reflest_core.models.registry import models

EPILOG = """A capture is an .mcap or .db3 file, a rosbag2 directory, a 7-Scenes folder or a TUM
folder. Topics are found by their types; name them where several would fit."""


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
        "--known-light",
        metavar="PATH",
        help="an .hdr or .exr panorama of the room, or a scan saved there: for light no camera "
        "saw; of a folder of them the room that fits, however it is turned",
    )
    parser.add_argument("--model", help=f"one of {', '.join(models())}")
    parser.add_argument("--weights", metavar="FILE", help="weights in place of the shipped ones")
    parser.add_argument("--config", type=Path, metavar="YAML", help="a ROS parameter file")
    topics = parser.add_argument_group("topics of a bag")
    for stream in ("rgb", "depth", "camera-info", "pose", "mask", "depth-camera-info"):
        topics.add_argument(f"--{stream}-topic", metavar="TOPIC")
    topics.add_argument(
        "--world-frame", metavar="FRAME", help="take poses from tf: the camera's in this frame"
    )
    scene = parser.add_argument_group("scene, over what --config says (world frame, metres)")
    roi = scene.add_mutually_exclusive_group()
    roi.add_argument(
        "--roi-box",
        type=float,
        nargs=6,
        metavar=("X0", "Y0", "Z0", "X1", "Y1", "Z1"),
        help="the object lies between these two corners",
    )
    roi.add_argument(
        "--roi-sphere",
        type=float,
        nargs=4,
        metavar=("X", "Y", "Z", "R"),
        help="the object lies in this sphere",
    )
    scene.add_argument("--voxel-size", type=float, metavar="M")
    scene.add_argument("--max-depth", type=float, metavar="M", help="what is further is background")
    scene.add_argument(
        "--up",
        type=float,
        nargs=3,
        metavar=("X", "Y", "Z"),
        help="up in the poses' world, default 0 0 1; 7-Scenes: 0 -1 0",
    )
    scene.add_argument(
        "--intrinsics",
        type=float,
        nargs=4,
        metavar=("FX", "FY", "CX", "CY"),
        help="calibration of a folder of frames, pixels",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Replay, print an estimate at every keyframe and the final one; write what was asked for.

    Args:
        options: all options of the command.
    """
    from reflest_core.cli.replay_run import replay

    replay(options)
    return 0
