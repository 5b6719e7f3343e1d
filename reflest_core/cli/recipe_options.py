# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Options of ``reflest train`` that change fields of a recipe."""

from __future__ import annotations

import argparse
import dataclasses
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reflest_core.models.recipe import Recipe

CHANGES = (
    "optimiser",
    "learning_rate",
    "momentum",
    "minibatches",
    "batch_size",
    "voxels",
    "nodes_per_voxel",
    "warm_up",
    "hold",
    "average",
    "precision",
    "parts",
    "seed",
    "only",
)
"""The fields of a recipe that options of the same name change."""
OWN = "default: the recipe's"


def add_recipe_options(parser: argparse.ArgumentParser) -> None:
    """Add an option for every field that is worth changing.

    Args:
        parser: The parser of ``reflest train``.
    """
    parser.add_argument("--optimiser", choices=("adam", "adamw", "rmsprop", "sgd"), help=OWN)
    parser.add_argument("--learning-rate", type=float, help=OWN)
    parser.add_argument("--momentum", type=float, help=f"of rmsprop and sgd; {OWN}")
    parser.add_argument("--minibatches", type=int, help=OWN)
    parser.add_argument("--batch-size", type=int, help=f"scenes in each part of a minibatch; {OWN}")
    parser.add_argument("--voxels", type=int, help=f"of one scene in a minibatch; {OWN}")
    parser.add_argument("--nodes-per-voxel", type=int, help=f"of Grouplet; {OWN}")
    parser.add_argument("--warm-up", type=int, metavar="MINIBATCHES", help=OWN)
    parser.add_argument(
        "--hold", type=float, help=f"share of training before the rate falls to 0; {OWN}"
    )
    parser.add_argument("--average", type=float, help=f"decay of the weights' running mean; {OWN}")
    parser.add_argument("--precision", choices=("float32", "bfloat16"), help=OWN)
    parser.add_argument("--parts", type=int, help="of a minibatch; default: one for each process")
    parser.add_argument(
        "--views",
        type=int,
        nargs=2,
        metavar=("FEWEST", "MOST"),
        help=f"kept of each scene's; {OWN}",
    )
    parser.add_argument(
        "--candidates",
        type=int,
        help=f"random voxels of a scene from which those are chosen; {OWN}",
    )
    parser.add_argument("--seed", type=int, help=OWN)
    parser.add_argument(
        "--only",
        metavar="PREFIX",
        help="train only tensors whose names begin so, and keep the others as --from has them",
    )


def changed_recipe(base: Recipe, arguments: argparse.Namespace, parts: int) -> Recipe:
    """Return the recipe with what the options change.

    Args:
        base: The network's recipe.
        arguments: All options.
        parts: Parts of a minibatch unless the options say otherwise.
    """
    given = {field: getattr(arguments, field) for field in CHANGES}
    changes = {field: value for field, value in given.items() if value is not None}
    changes.setdefault("parts", parts)
    augmentation = base.augmentation
    if arguments.views:
        fewest, most = arguments.views
        augmentation = dataclasses.replace(augmentation, views=(fewest, most))
    if arguments.candidates:
        augmentation = dataclasses.replace(augmentation, candidates=arguments.candidates)
    return dataclasses.replace(base, augmentation=augmentation, **changes)
