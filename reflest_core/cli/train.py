"""``reflest train``: a network from a SynBRDF folder."""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path
from typing import Any


def add_parser(subparsers: Any) -> None:
    """Add the subcommand."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "train", help="train a network on SynBRDF scenes (resumes where it was stopped)"
    )
    parser.add_argument("data", type=Path, help="folder written by 'reflest synbrdf generate'")
    parser.add_argument("--model", choices=("hemicnn", "grouplet"), required=True)
    parser.add_argument("--loss", choices=("rmse1", "rmse2", "cuberoot"), default="rmse1")
    parser.add_argument(
        "--lambda", dest="colour_constancy", type=float, default=0.0, help="weight of E_c (Eq. 4)"
    )
    parser.add_argument("--minibatches", type=int, help="default: the paper's")
    parser.add_argument("--batch-size", type=int)
    parser.add_argument("--learning-rate", type=float, help="default: the paper's")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, help="CPU threads; default: all")
    parser.add_argument("--out", type=Path, required=True, help="folder for weights and log")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Train to the end and say where the weights are."""
    import torch

    from reflest_core.training.recipe import PAPER_RECIPES
    from reflest_core.training.sample import load_samples
    from reflest_core.training.trainer import Trainer

    if arguments.threads:
        torch.set_num_threads(arguments.threads)
    given = {
        "loss": arguments.loss,
        "colour_constancy": arguments.colour_constancy,
        "minibatches": arguments.minibatches,
        "batch_size": arguments.batch_size,
        "learning_rate": arguments.learning_rate,
        "seed": arguments.seed,
    }
    changes = {name: value for name, value in given.items() if value is not None}
    recipe = dataclasses.replace(PAPER_RECIPES[arguments.model], **changes)
    training = load_samples(arguments.data, "train")
    validation = load_samples(arguments.data, "validation")
    counts = {"train": len(training), "validation": len(validation)}
    print(f"training {recipe.network} on {counts['train']} scenes: {recipe}")
    path = Trainer(recipe, training, validation, arguments.out, counts).run()
    print(f"weights: {path}")
    return 0
