# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Options that say which data set is meant; the same ones give the same scenes everywhere."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reflest_core.synbrdf.generation.data_set import Generation
    from reflest_core.synbrdf.realism.settings import Realism
    from reflest_core.synbrdf.scenes.material_sources import Materials


def add_set_options(parser: argparse.ArgumentParser) -> None:
    """Add the options that :func:`generation_of` reads.

    Args:
        parser: takes the options.
    """
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--train", type=int, default=4600, help="scenes")
    parser.add_argument("--validation", type=int, default=400, help="scenes")
    parser.add_argument("--unseen", type=int, default=400, help="scenes of unseen light and shape")
    parser.add_argument("--views", type=int, default=100, help="views of a scene")
    parser.add_argument(
        "--environments", type=Path, help=".hdr, .exr or .npz files; default: procedural skies"
    )
    parser.add_argument(
        "--extra-environments", type=Path, help="further ones, for training scenes alone"
    )
    parser.add_argument("--meshes", type=Path, help=".obj, .ply or .npz; default: procedural only")
    parser.add_argument(
        "--lighting",
        choices=("natural", "diverse", "near"),
        default="natural",
        help="of training scenes; near: all scenes stand in rooms",
    )
    parser.add_argument(
        "--without", nargs="*", default=[], metavar="NAME", help="environments to leave out"
    )
    parser.add_argument(
        "--metering",
        choices=("frame", "object"),
        default="frame",
        help="what the camera exposes for; frame lets objects in dark rooms clip",
    )
    parser.add_argument(
        "--product",
        choices=("object", "tabletop"),
        default="object",
        help="what a scene shows: one object of one material, as in the paper, or 2 to 6 objects "
        "of several materials on a table or in a corner (SynBRDF-SV)",
    )
    parser.add_argument(
        "--surface",
        choices=("exact", "fused"),
        default="exact",
        help="where voxels come from: the true surface, or fusion of depth images of all views",
    )
    add_material_options(parser)
    add_realism_option(parser)


def add_material_options(parser: argparse.ArgumentParser) -> None:
    """Add ``--materials``, ``--material-fits`` and ``--measured-share``.

    Args:
        parser: Takes the options.
    """
    parser.add_argument(
        "--materials",
        choices=("opensurfaces", "measured"),
        default="opensurfaces",
        help="what materials are drawn from: OpenSurfaces' space, as in the paper, or a "
        "distribution that follows measured materials (default: %(default)s)",
    )
    parser.add_argument(
        "--material-fits",
        type=Path,
        metavar="CSV",
        help="Ward fits to draw from instead, in a data set for its unseen split alone; needs "
        "--materials measured",
    )
    parser.add_argument(
        "--measured-share",
        type=float,
        default=1.0,
        metavar="SHARE",
        help="of the materials that are measured ones with --materials measured; the rest are "
        "OpenSurfaces' (default: %(default)s)",
    )


def materials_of(arguments: argparse.Namespace) -> Materials:
    """What ``--materials``, ``--material-fits`` and ``--measured-share`` name.

    Args:
        arguments: All options of the command.
    """
    from reflest_core.synbrdf.scenes.material_sources import Materials, MaterialSource

    return Materials(
        MaterialSource(arguments.materials),
        _absolute(arguments.material_fits),
        arguments.measured_share,
    )


def add_realism_option(parser: argparse.ArgumentParser) -> None:
    """Add ``--realism``.

    Args:
        parser: takes the options.
    """
    parser.add_argument(
        "--realism",
        nargs="*",
        metavar="EFFECT",
        help="faults of real captures: exposure, white-balance, sensor, jpeg, depth, pose, "
        "normals; all of them if none is named",
    )


def realism_of(arguments: argparse.Namespace) -> Realism | None:
    """The faults that ``--realism`` names; None without it.

    Args:
        arguments: all options of the command.
    """
    from reflest_core.synbrdf.realism.settings import Realism, parse_effects

    if arguments.realism is None:
        return None
    return Realism.only(parse_effects(arguments.realism or ["all"]))


def generation_of(
    arguments: argparse.Namespace, points: int = 400, samples: int = 64
) -> Generation:
    """The data set that the options name.

    Args:
        arguments: All options of the command.
        points: Voxels of a scene.
        samples: Paths of an observation.
    """
    from reflest_core.synbrdf.generation.data_set import Generation, Product
    from reflest_core.synbrdf.scenes.metering import Metering
    from reflest_core.synbrdf.scenes.scene import Lighting
    from reflest_core.synbrdf.scenes.surface_points import SurfaceKind

    return Generation(
        arguments.seed,
        {split: getattr(arguments, split) for split in ("train", "validation", "unseen")},
        points,
        arguments.views,
        samples,
        _absolute(arguments.environments),
        _absolute(arguments.meshes),
        Lighting(arguments.lighting),
        tuple(arguments.without),
        realism_of(arguments),
        Metering(arguments.metering),
        _absolute(arguments.extra_environments),
        Product(arguments.product),
        materials_of(arguments),
        SurfaceKind(arguments.surface),
    )


def _absolute(path: Path | None) -> Path | None:
    """Workers elsewhere have other working directories."""
    return None if path is None else path.absolute()
