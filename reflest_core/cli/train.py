"""``reflest train``: networks from a SynBRDF folder."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reflest_core.parameter import ParameterError

if TYPE_CHECKING:
    from reflest_core.training.data import TrainingData
    from reflest_core.training.processes import Processes
    from reflest_core.training.recipe import Recipe

CHANGES = (
    "optimiser", "learning_rate", "momentum", "minibatches", "batch_size", "voxels",
    "nodes_per_voxel", "warm_up", "hold", "average", "precision", "parts", "seed",
)  # fmt: skip
"""The fields of a recipe that options of the same name change."""


def add_parser(subparsers: Any) -> None:
    """Add the subcommand."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "train",
        help="train networks on SynBRDF scenes (resumes where it was stopped)",
        epilog="torchrun --nproc-per-node N -m reflest_core.cli.main train ... shares each "
        "minibatch among N processes.",
    )
    parser.add_argument(
        "data", type=Path, help="folder written by 'reflest synbrdf generate', or by --pack"
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--variant", help="a variant of Table 2, such as grouplet-rmse1-ec")
    what.add_argument("--all", action="store_true", help="all seven, each in OUT/<variant>")
    what.add_argument(
        "--pack", action="store_true",
        help="train nothing: write into OUT what training reads, a twelfth of the data's size",
    )  # fmt: skip
    what.add_argument("--model", choices=("hemicnn", "grouplet"), help="with --loss and --lambda")
    parser.add_argument("--loss", choices=("rmse1", "rmse2", "cuberoot"), help="default: rmse1")
    parser.add_argument(
        "--lambda", dest="colour_constancy", type=float, help="weight of E_c (Eq. 4); default: 0"
    )
    parser.add_argument(
        "--recipe", choices=("ours", "paper"), default="ours", help="what is not given otherwise"
    )
    _add_changes(parser)
    parser.add_argument(
        "--realism", nargs="*", metavar="EFFECT",
        help="train on every scene a second time, with the faults of a real capture; "
        "no EFFECT: all of them",
    )  # fmt: skip
    parser.add_argument("--device", default="auto", help="auto, cpu, cuda or cuda:N")
    parser.add_argument("--threads", type=int, help="CPU threads; default: all")
    parser.add_argument("--validate-every", type=int, default=1000, metavar="MINIBATCHES")
    parser.add_argument("--tensorboard", action="store_true", help="log to OUT/tensorboard too")
    parser.add_argument("--out", type=Path, required=True, help="folder for weights and log")
    parser.set_defaults(run=run)


def _add_changes(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--optimiser", choices=("adam", "rmsprop", "sgd"))
    parser.add_argument("--learning-rate", type=float)
    parser.add_argument("--momentum", type=float, help="of rmsprop and sgd")
    parser.add_argument("--minibatches", type=int)
    parser.add_argument("--batch-size", type=int, help="scenes in each part of a minibatch")
    parser.add_argument("--voxels", type=int, help="of one scene in a minibatch")
    parser.add_argument("--nodes-per-voxel", type=int, help="of Grouplet")
    parser.add_argument("--warm-up", type=int, metavar="MINIBATCHES")
    parser.add_argument("--hold", type=float, help="share of training before the rate falls to 0")
    parser.add_argument("--average", type=float, help="decay of the weights' running mean")
    parser.add_argument("--precision", choices=("float32", "bfloat16"))
    parser.add_argument("--parts", type=int, help="of a minibatch; default: one for each process")
    parser.add_argument("--seed", type=int)


def run(arguments: argparse.Namespace) -> int:
    """Train to the end and say where the weights are."""
    import torch

    from reflest_core.training.processes import joined_processes
    from reflest_core.training.variants import VARIANTS

    if arguments.threads:
        torch.set_num_threads(arguments.threads)
    if arguments.variant or arguments.all:
        for name in ("loss", "colour_constancy"):
            if getattr(arguments, name) is not None:
                raise ParameterError("--loss and --lambda go with --model: a variant has its own")
    if arguments.pack:
        from reflest_core.training.data import pack

        pack(_load(arguments), arguments.out)
        return 0
    with joined_processes(arguments.device) as processes:
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


def _load(arguments: argparse.Namespace) -> TrainingData:
    from reflest_core.synbrdf.realism.settings import Realism, parse_effects
    from reflest_core.training.data import load_training_data
    from reflest_core.training.sample import Degradation

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
    import dataclasses

    from reflest_core.training.trainer import RunFolder, Trainer

    given = {field: getattr(arguments, field) for field in CHANGES}
    changes = {field: value for field, value in given.items() if value is not None}
    changes.setdefault("parts", processes.count)
    recipe = dataclasses.replace(base, **changes)
    place = RunFolder(folder, name, arguments.validate_every, arguments.tensorboard)
    if processes.is_first:
        print(f"training {name} on {len(data.training)} scenes: {recipe}", flush=True)
    path = Trainer(recipe, data, place, processes).run()
    if processes.is_first:
        print(f"weights: {path}", flush=True)


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
