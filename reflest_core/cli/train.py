# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest train``: networks from SynBRDF folders."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reflest_core.cli.output_files import check_overwriting
from reflest_core.cli.recipe_options import add_recipe_options, changed_recipe
from reflest_core.models.definition import OURS, PAPER, SCENES
from reflest_core.models.registry import network_named, networks
from reflest_core.parameter import ParameterError
from reflest_core.training.method import (
    TrainingMethod,
    refuse_options_of_others,
    training_method,
)

if TYPE_CHECKING:
    from reflest_core.models.recipe import Recipe
    from reflest_core.training.processes import Processes


@dataclass(frozen=True)
class _Wanted:
    """One training that the command asks for: what, by which recipe, where."""

    name: str
    recipe: Recipe
    folder: Path


def add_parser(subparsers: Any) -> None:
    """Add the subcommand.

    Args:
        subparsers: Of the parser of ``reflest``.
    """
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
        "--model", metavar="NETWORK", help=f"a network, one of {', '.join(networks())}"
    )
    parser.add_argument(
        "--recipe",
        choices=(OURS, PAPER, SCENES),
        default=OURS,
        help="what is not given otherwise; scenes: lightnet for materials among others, from "
        "folders of bags of 'reflest synbrdf tabletop'",
    )
    parser.add_argument(
        "--from",
        dest="start",
        type=Path,
        metavar="WEIGHTS",
        help="begin with these weights, of another variant perhaps; the last layer begins at "
        "random where the loss is written in other parameters",
    )
    add_recipe_options(parser)
    for method in {network.training: None for network in networks().values()}:
        training_method(method).add_options(parser)
    parser.add_argument("--device", default="auto", help="auto, cpu, cuda or cuda:N")
    parser.add_argument("--threads", type=int, help="CPU threads; default: all")
    parser.add_argument("--validate-every", type=int, default=1000, metavar="MINIBATCHES")
    parser.add_argument("--tensorboard", action="store_true", help="log to OUT/tensorboard too")
    parser.add_argument("--out", type=Path, required=True, help="folder for weights and log")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Train to the end and say where the weights are.

    Args:
        arguments: All options.
    """
    import torch

    from reflest_core.training.processes import joined_processes, keep_freed_memory

    keep_freed_memory()
    if arguments.threads:
        torch.set_num_threads(arguments.threads)
    _refuse_contradictions(arguments)
    if arguments.pack:
        return _pack(arguments)
    made = {path: training_method(path) for path in {n.training for n in networks().values()}}
    methods = {name: made[network.training] for name, network in networks().items()}
    wanted = _wanted(arguments)
    for one in wanted:
        start = [] if arguments.start is None else [arguments.start]
        check_overwriting({"--out": one.folder / f"{one.name}.safetensors"}, start)
        refuse_options_of_others(methods[one.recipe.network], methods, arguments)
    with joined_processes(arguments.device) as processes:
        for one in wanted:
            _train(one, methods[one.recipe.network], arguments, processes)
    return 0


def _refuse_contradictions(arguments: argparse.Namespace) -> None:
    if arguments.variant or arguments.all:
        for name in ("loss", "colour_constancy"):
            if getattr(arguments, name) is not None:
                raise ParameterError("--loss and --lambda go with --model: a variant has its own")
    if arguments.all and arguments.start:
        raise ParameterError("--from goes with one variant or --model: --all has two networks")
    if arguments.pack and arguments.out.resolve() in {one.resolve() for one in arguments.data}:
        raise ParameterError(f"--pack: --out {arguments.out} is the data itself: name a new folder")


def _pack(arguments: argparse.Namespace) -> int:
    from reflest_core.training.data.sample_sets import pack
    from reflest_core.training.surface.method import SurfaceTraining

    pack(SurfaceTraining().data(arguments), arguments.out)
    return 0


def _wanted(arguments: argparse.Namespace) -> list[_Wanted]:
    from reflest_core.training.variants import VARIANTS, variant_named

    origin = arguments.recipe
    if arguments.all:
        return [
            _Wanted(variant.name, variant.recipe(origin), arguments.out / variant.name)
            for variant in VARIANTS
        ]
    if arguments.variant:
        variant = variant_named(arguments.variant)
        return [_Wanted(variant.name, variant.recipe(origin), arguments.out)]
    network = network_named(arguments.model)
    return [_Wanted(network.name, network.recipe(origin), arguments.out)]


def _train(
    wanted: _Wanted, method: TrainingMethod, arguments: argparse.Namespace, processes: Processes
) -> None:
    import dataclasses

    from reflest_core.training.starting_weights import StartingWeights
    from reflest_core.training.task import RunFolder
    from reflest_core.training.trainer import Trainer

    recipe = changed_recipe(wanted.recipe, arguments, parts=processes.count)
    recipe = method.recipe(recipe, arguments)
    start = None
    if arguments.start is not None:
        start = StartingWeights.read(arguments.start, recipe)
        recipe = dataclasses.replace(recipe, start=start.name)
    task = method.task(network_named(recipe.network), recipe, arguments, processes)
    folder = RunFolder(wanted.folder, wanted.name, arguments.validate_every, arguments.tensorboard)
    if processes.is_first:
        print(f"training {wanted.name} on {task.examples} examples: {recipe}", flush=True)
    path = Trainer(task, folder, processes, start).run()
    if processes.is_first:
        print(f"weights: {path}", flush=True)
