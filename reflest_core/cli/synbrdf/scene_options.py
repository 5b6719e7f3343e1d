# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Options that choose scenes and views of a data set."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from reflest_core.cli.synbrdf.set_options import add_set_options

if TYPE_CHECKING:
    from reflest_core.synbrdf.generation.data_set import Generation
    from reflest_core.synbrdf.scenes.splits import Split


def add_scene_options(parser: argparse.ArgumentParser, frames: str) -> None:
    """Add the options that say which set, and which of its scenes and views.

    Args:
        parser: takes the options.
        frames: what single views are called in the help.
    """
    parser.add_argument("--split", choices=("train", "validation", "unseen"), default="train")
    parser.add_argument(
        "--scenes", default="0", metavar="RANGE", help="such as 3 or 0:10,25 (default: %(default)s)"
    )
    parser.add_argument(
        "--frames",
        default=frames,
        metavar="RANGE",
        help="views, such as 0:100:10 (default: %(default)s)",
    )
    parser.add_argument("--width", type=int, default=640, help="pixels")
    parser.add_argument("--height", type=int, default=480, help="pixels")
    parser.add_argument("--samples", type=int, default=64, help="paths of a pixel")
    add_set_options(parser)


def chosen(
    arguments: argparse.Namespace, generation: Generation
) -> tuple[Split, list[int], list[int]]:
    """Split, scenes and views that the options name; refuses what the set does not have.

    Args:
        arguments: all options of the command.
        generation: what the data set was asked to be.
    """
    from reflest_core.synbrdf.generation.index_ranges import IndexRangeError, parse_indices
    from reflest_core.synbrdf.path_tracing.path_counts import check_paths
    from reflest_core.synbrdf.scenes.splits import Split

    for name in ("width", "height"):
        if not 16 <= getattr(arguments, name) <= 4096:
            raise IndexRangeError(f"--{name} is {getattr(arguments, name)}, but must be 16 to 4096")
    if arguments.samples < 4 or arguments.samples % 4:
        raise IndexRangeError(f"--samples is {arguments.samples}, but must be a multiple of 4")
    check_paths(arguments.samples, rays=4)
    split = Split(arguments.split)
    scenes = parse_indices(arguments.scenes, generation.scenes[split.value], "scenes")
    return split, scenes, parse_indices(arguments.frames, generation.views, "frames")
