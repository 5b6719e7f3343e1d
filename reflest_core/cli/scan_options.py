# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Options of the commands that scan a capture: ``replay``, ``view`` and ``export``."""

from __future__ import annotations

import argparse
from pathlib import Path

from reflest_core.models.registry import models


def add_scan_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that say how a capture is scanned and estimated.

    Args:
        parser: Of a command that reads captures.
    """
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
    roi.add_argument(
        "--roi-pixel",
        type=float,
        nargs=4,
        metavar=("FRAME", "U", "V", "R"),
        help="the object lies within R metres of what column U, row V of this frame shows; frames "
        "count from 0",
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
