# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf images``: full RGB-D images of the data set's scenes."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from reflest_core.cli.synbrdf.scene_options import add_scene_options, chosen
from reflest_core.cli.synbrdf.set_options import generation_of


def add_parser(products: Any) -> None:
    """Add the subcommand.

    Args:
        products: the subcommands of ``reflest synbrdf``.
    """
    parser: argparse.ArgumentParser = products.add_parser(
        "images",
        help="full images of scenes: HDR and LDR colour, depth, normals, mask, poses, intrinsics",
    )
    parser.add_argument("--out", type=Path, required=True, help="folder; resumes if it exists")
    add_scene_options(parser, frames="0:100:10")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write one folder for each scene.

    Args:
        arguments: all options of the command.
    """
    generation = generation_of(arguments)
    split, scenes, views = chosen(arguments, generation)

    from reflest_core.synbrdf.path_tracing.scene_images import SceneImages

    images = SceneImages(generation, arguments.width, arguments.height, arguments.samples)
    for index in scenes:
        print(images.write(arguments.out, split, index, views))
    return 0
