# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest synbrdf card``: the data card's pictures and numbers."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

from reflest_core.cli.synbrdf.set_options import add_set_options, generation_of

SPLITS = ("train", "validation", "unseen")
ROWS, COLUMNS = 8, 12
QUALITY = 85


def add_parser(products: Any) -> None:
    """Add the subcommand.

    Args:
        products: the subcommands of ``reflest synbrdf``.
    """
    parser: argparse.ArgumentParser = products.add_parser(
        "card", help="the data card: histograms and numbers of a set, and a contact sheet"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder")
    parser.add_argument(
        "--data", type=Path, help="a generated set, for histograms and numbers; needs matplotlib"
    )
    parser.add_argument(
        "--contact-sheet", choices=SPLITS, help="render the first views of scenes of this split"
    )
    parser.add_argument(
        "--full-images", metavar="RANGE", help="render what full images hold, of training scenes"
    )
    add_set_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Write what was asked for.

    Args:
        arguments: all options of the command.
    """
    from reflest_core.whole_file import OutputError

    try:
        arguments.out.mkdir(parents=True, exist_ok=True)
        if arguments.data is not None:
            _write_figures(arguments.data, arguments.out)
        if arguments.contact_sheet is not None:
            _write_contact_sheet(arguments)
        if arguments.full_images is not None:
            _write_image_strip(arguments)
    except OSError as error:
        raise OutputError(
            f"cannot write {arguments.out}: {error.strerror}; choose another --out"
        ) from error
    return 0


def _write_figures(data: Path, out: Path) -> None:
    from reflest_core.synbrdf.card.histograms import draw_captures, draw_materials
    from reflest_core.synbrdf.card.numbers import clipping, table
    from reflest_core.synbrdf.card.summary import summarise

    scenes = summarise(data, SPLITS)
    draw_materials(scenes, out / "materials.png")
    draw_captures(scenes, out / "captures.png")
    text = f"# SynBRDF in numbers\n\n{table(scenes)}\nClipping: {clipping(scenes)}"
    (out / "numbers.md").write_text(text)


def _write_contact_sheet(arguments: argparse.Namespace) -> None:
    from reflest_core.synbrdf.card.contact_sheet import contact_sheet
    from reflest_core.synbrdf.generation.data_set import Product
    from reflest_core.synbrdf.path_tracing.image_files import write_rgb
    from reflest_core.synbrdf.scenes.scene import Lighting
    from reflest_core.synbrdf.scenes.splits import Split

    split = Split(arguments.contact_sheet)
    generation = generation_of(arguments)
    rows = min(ROWS, math.ceil(generation.scenes[split.value] / COLUMNS))
    sheet = contact_sheet(generation, split, rows, COLUMNS)
    is_natural = generation.lighting is Lighting.NATURAL
    kind = split.value if is_natural else f"{generation.lighting.value}-{split.value}"
    if generation.product is Product.TABLETOP:
        kind = f"tabletop-{kind}"
    write_rgb(arguments.out / f"contact-sheet-{kind}.jpg", sheet, QUALITY)


def _write_image_strip(arguments: argparse.Namespace) -> None:
    import dataclasses

    from reflest_core.synbrdf.card.image_strip import image_strip
    from reflest_core.synbrdf.generation.index_ranges import parse_indices
    from reflest_core.synbrdf.path_tracing.image_files import write_rgb
    from reflest_core.synbrdf.realism.settings import Realism
    from reflest_core.synbrdf.scenes.splits import Split

    generation = generation_of(arguments)
    generation = dataclasses.replace(generation, realism=generation.realism or Realism())
    count = generation.scenes[Split.TRAIN.value]
    indices = parse_indices(arguments.full_images, count, "full-images")
    strip = image_strip(generation, Split.TRAIN, indices, view=0)
    write_rgb(arguments.out / "full-images.jpg", strip, QUALITY)
