"""``reflest synbrdf``: generate the data set."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any


def add_parser(subparsers: Any) -> None:
    """Add the subcommand and its own subcommands."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "synbrdf", help="generate SynBRDF scenes and sequences (needs the extra synbrdf)"
    )
    products = parser.add_subparsers(required=True, metavar="PRODUCT")
    _add_generate(products)


def _add_generate(products: Any) -> None:
    parser: argparse.ArgumentParser = products.add_parser(
        "generate", help="sparse scenes for training: each surface point's colour from each view"
    )
    parser.add_argument("--out", type=Path, required=True, help="folder; resumes if it exists")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--train", type=int, default=4600, help="scenes")
    parser.add_argument("--validation", type=int, default=400, help="scenes")
    parser.add_argument("--unseen", type=int, default=400, help="scenes of held-out light and shape")
    parser.add_argument("--points", type=int, default=400, help="surface points of a scene")
    parser.add_argument("--views", type=int, default=100, help="views of a scene")
    parser.add_argument("--samples", type=int, default=64, help="paths of an observation")
    parser.add_argument(
        "--environments", type=Path, help=".hdr, .exr or .npz files; default: procedural skies"
    )
    parser.add_argument("--meshes", type=Path, help=".obj, .ply or .npz; default: procedural only")
    parser.add_argument("--jobs", type=int, default=1, help="processes, each with all cores")
    parser.set_defaults(run=run_generate)


def run_generate(arguments: argparse.Namespace) -> int:
    """Generate until every shard is there."""
    from reflest_core.synbrdf.generate import Generation, generate

    scenes = {split: getattr(arguments, split) for split in ("train", "validation", "unseen")}
    generation = Generation(
        arguments.seed,
        scenes,
        arguments.points,
        arguments.views,
        arguments.samples,
        arguments.environments,
        arguments.meshes,
    )
    generate(arguments.out, generation, arguments.jobs)
    return 0
