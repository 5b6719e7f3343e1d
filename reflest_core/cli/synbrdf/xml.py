# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf xml``: the data set's scenes as Mitsuba files."""

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
        "xml", help="scenes as Mitsuba 3 files with mesh and light; render them with 'render'"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder; scenes there are kept")
    add_scene_options(parser, frames="0:100")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write one folder for each scene.

    Args:
        arguments: all options of the command.
    """
    generation = generation_of(arguments)
    split, scenes, views = chosen(arguments, generation)

    from reflest_core.synbrdf.path_tracing.mitsuba_xml import write_scene
    from reflest_core.synbrdf.scenes.views import depth_camera

    camera = depth_camera(arguments.width, arguments.height)
    for index in scenes:
        folder = arguments.out / f"{split.value}-{index:05d}"
        if not folder.exists():
            write_scene(folder, generation.scene(split, index), camera, views, arguments.samples)
        print(folder)
    return 0
