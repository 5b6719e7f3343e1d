# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest train``: networks from a SynBRDF folder."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reflest_core.cli.light_options import (
    add_light_options,
    light_course,
    light_recipe,
    refuse_light_options,
)
from reflest_core.cli.recipe_options import add_recipe_options, changed_recipe
from reflest_core.cli.training_run import follow, started
from reflest_core.parameter import ParameterError

if TYPE_CHECKING:
    from reflest_core.training.data.sample_sets import TrainingData
    from reflest_core.training.processes import Processes
    from reflest_core.training.recipe import Recipe


def add_parser(subparsers: Any) -> None:
    """Add the subcommand."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "train",
        help="train networks on SynBRDF scenes (resumes where it was stopped)",
        epilog="torchrun --nproc-per-node N -m reflest_core.cli.main train ... shares each "
        "minibatch among N processes.",
    )
    parser.add_argument(
        "data",
        type=Path,
        nargs="+",
        help="folders of 'reflest synbrdf generate', or of --pack; validation is the first's",
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--variant", help="a variant of Table 2, such as grouplet-rmse1-ec")
    what.add_argument("--all", action="store_true", help="all seven, each in OUT/<variant>")
    what.add_argument(
        "--pack",
        action="store_true",
        help="train nothing: write into OUT what training reads, a twelfth of the data's size",
    )
    what.add_argument(
        "--model",
        choices=("lightnet", "hemicnn", "grouplet"),
        help="the latter two with --loss and --lambda",
    )
    parser.add_argument("--loss", choices=("rmse1", "rmse2", "cuberoot"), help="default: rmse1")
    parser.add_argument(
        "--lambda", dest="colour_constancy", type=float, help="weight of E_c (Eq. 4); default: 0"
    )
    parser.add_argument(
        "--recipe", choices=("ours", "paper"), default="ours", help="what is not given otherwise"
    )
    parser.add_argument(
        "--from",
        dest="start",
        type=Path,
        metavar="WEIGHTS",
        help="begin with these weights, of another variant perhaps; its last layer is made anew "
        "where the loss is written in other parameters",
    )
    add_recipe_options(parser)
    add_light_options(parser)
    parser.add_argument(
        "--realism",
        nargs="*",
        metavar="EFFECT",
        help="train on every scene a second time, with the faults of a real capture; "
        "no EFFECT: all of them",
    )
    parser.add_argument("--device", default="auto", help="auto, cpu, cuda or cuda:N")
    parser.add_argument("--threads", type=int, help="CPU threads; default: all")
    parser.add_argument("--validate-every", type=int, default=1000, metavar="MINIBATCHES")
    parser.add_argument("--tensorboard", action="store_true", help="log to OUT/tensorboard too")
    parser.add_argument("--out", type=Path, required=True, help="folder for weights and log")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Train to the end and say where the weights are."""
    import torch

    from reflest_core.training.kept_memory import keep_freed_memory
    from reflest_core.training.processes import joined_processes
    from reflest_core.training.variants import VARIANTS

    keep_freed_memory()
    if arguments.threads:
        torch.set_num_threads(arguments.threads)
    _refuse_contradictions(arguments)
    if arguments.pack:
        from reflest_core.training.data.sample_sets import pack

        pack(_load(arguments), arguments.out)
        return 0
    with joined_processes(arguments.device) as processes:
        if arguments.model == "lightnet":
            _train_lightnet(arguments, processes)
            return 0
        data = _load(arguments)
        if not arguments.all:
            name = arguments.variant or arguments.model
            _train(arguments, _base(arguments), data, arguments.out, name, processes)
            return 0
        for variant in VARIANTS:
            folder = arguments.out / variant.name
            recipe = variant.recipe(arguments.recipe)
            _train(arguments, recipe, data, folder, variant.name, processes)
    return 0


def _refuse_contradictions(arguments: argparse.Namespace) -> None:
    if arguments.variant or arguments.all:
        for name in ("loss", "colour_constancy"):
            if getattr(arguments, name) is not None:
                raise ParameterError("--loss and --lambda go with --model: a variant has its own")
    if arguments.all and arguments.start:
        raise ParameterError("--from goes with one variant or --model: --all has two networks")
    if arguments.model != "lightnet":
        refuse_light_options(arguments)


def _load(arguments: argparse.Namespace) -> TrainingData:
    from reflest_core.synbrdf.realism.settings import Realism, parse_effects
    from reflest_core.training.data.sample import Degradation
    from reflest_core.training.data.sample_sets import load_training_data

    if arguments.realism is None:
        return load_training_data(arguments.data)
    effects = parse_effects(arguments.realism or ["all"])
    seed = 1 if arguments.seed is None else arguments.seed
    return load_training_data(arguments.data, Degradation(Realism.only(effects), seed))


def _train(
    arguments: argparse.Namespace,
    base: Recipe,
    data: TrainingData,
    folder: Path,
    name: str,
    processes: Processes,
) -> None:
    from reflest_core.training.surface.surface_course import SurfaceCourse

    recipe, start = started(changed_recipe(base, arguments, parts=processes.count), arguments)
    course = SurfaceCourse(recipe, data, processes.device)
    follow(course, len(data.training), arguments, folder, name, processes, start)


def _train_lightnet(arguments: argparse.Namespace, processes: Processes) -> None:
    from reflest_core.training.recipe import RECIPES

    recipe = changed_recipe(RECIPES["lightnet"], arguments, parts=processes.count)
    recipe, start = started(light_recipe(recipe, arguments), arguments)
    course = light_course(recipe, arguments, processes)
    looks = len(course.data.training)
    follow(course, looks, arguments, arguments.out, "lightnet", processes, start)


def _base(arguments: argparse.Namespace) -> Recipe:
    """The recipe of --variant or --model before the options that change it."""
    import dataclasses

    from reflest_core.training.recipe import PAPER_RECIPES, RECIPES
    from reflest_core.training.variants import variant_named

    if arguments.variant:
        return variant_named(arguments.variant).recipe(arguments.recipe)
    base = {"ours": RECIPES, "paper": PAPER_RECIPES}[arguments.recipe][arguments.model]
    return dataclasses.replace(
        base, loss=arguments.loss or "rmse1", colour_constancy=arguments.colour_constancy or 0.0
    )
