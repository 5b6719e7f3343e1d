# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Options of the commands that scan a capture: ``replay``, ``view`` and ``export``."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from reflest_core.cli.output_files import RECORDING_SUFFIXES, check_overwriting
from reflest_core.cli.parser import check_source
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.models.registry import models
from reflest_core.parameter import ParameterError
from reflest_core.whole_file import check_writable

BY_TYPE = "found by its type, then by its name"
TOPICS = {
    "rgb": BY_TYPE,
    "depth": BY_TYPE,
    "camera-info": BY_TYPE,
    "pose": BY_TYPE,
    "mask": "none",
    "depth-camera-info": "the depth image's own, where there is one",
}
"""Streams of a bag, and what is taken for one whose topic is not named."""
CAPTURE_OPTIONS = (
    *(f"{stream}-topic" for stream in TOPICS),
    "world-frame",
    "roi-box",
    "roi-sphere",
    "roi-pixel",
    "voxel-size",
    "max-depth",
    "intrinsics",
)
"""Options that say how a capture is scanned, and change nothing in a scan that was saved."""


def is_saved(source: Path) -> bool:
    """Return whether a source is a saved scan or estimate rather than a capture.

    Args:
        source: What a command was given.
    """
    return source.is_file() and source.suffix not in RECORDING_SUFFIXES


def check_capture_options(options: argparse.Namespace) -> None:
    """Refuse options that would do nothing, because the scan was made before.

    Args:
        options: All options of a command with :func:`add_scan_options`.

    Raises:
        ParameterError: The source was saved, and an option of scanning was given; it is named.
    """
    if not is_saved(options.capture):
        return
    for name in CAPTURE_OPTIONS:
        if getattr(options, name.replace("-", "_")) is not None:
            raise ParameterError(
                f"--{name} only applies to a capture: {options.capture} was scanned before and has "
                "its own; leave the option out, or give the capture"
            )


def check_paths(
    options: argparse.Namespace, inputs: Sequence[str] = (), outputs: Sequence[str] = ()
) -> None:
    """Refuse paths that are not there, before anything slow is imported or scanned.

    Args:
        options: All options of a command with :func:`add_scan_options`.
        inputs: Further options that name something to read.
        outputs: Options that name a file to write.

    Raises:
        SourceMissing: Something to read does not exist; the nearest name beside it is suggested.
        OutputError: A file cannot be written there, or is one of what is read or written besides.
    """
    sources = [options.capture]
    for name in ("config", "weights", "known_light", *inputs):
        if (given := getattr(options, name)) is not None:
            sources.append(Path(given))
    for source in sources:
        check_source(source)
    written = {
        f"--{name.replace('_', '-')}": path
        for name in outputs
        if (path := getattr(options, name)) is not None
    }
    for path in written.values():
        check_writable(path)
    check_overwriting(written, sources)


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
    settings = ReflestSettings()
    parser.add_argument(
        "--model",
        choices=models(),
        metavar="MODEL",
        help=f"one of {', '.join(models())}; default: {settings.estimation.model}",
    )
    parser.add_argument(
        "--weights", metavar="FILE", help="weights of the model; default: the shipped ones"
    )
    parser.add_argument(
        "--config",
        type=Path,
        metavar="YAML",
        help="a ROS parameter file; default: the defaults of config/estimator.yaml",
    )
    topics = parser.add_argument_group("topics of a bag")
    for stream, default in TOPICS.items():
        topics.add_argument(f"--{stream}-topic", metavar="TOPIC", help=f"default: {default}")
    topics.add_argument(
        "--world-frame",
        metavar="FRAME",
        help="take poses from tf: the camera's in this frame; default: poses from the pose topic",
    )
    scene = parser.add_argument_group(
        "scene, over what --config says (world frame, metres); default: no region, all that is "
        "near is scanned"
    )
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
    scene.add_argument(
        "--voxel-size",
        type=float,
        metavar="M",
        help=f"edge of a voxel; default: {settings.fusion.voxel_size:g}",
    )
    scene.add_argument(
        "--max-depth",
        type=float,
        metavar="M",
        help=f"what is further is background; default: {settings.fusion.max_depth:g}",
    )
    scene.add_argument(
        "--up",
        type=float,
        nargs=3,
        metavar=("X", "Y", "Z"),
        help="up in the poses' world; default: 0 0 1 (7-Scenes: 0 -1 0)",
    )
    scene.add_argument(
        "--intrinsics",
        type=float,
        nargs=4,
        metavar=("FX", "FY", "CX", "CY"),
        help="calibration of a folder of frames, pixels; default: the folder's own",
    )
