"""``reflest evaluate``: what the shipped (or given) weights reach on SynBRDF splits."""

from __future__ import annotations

import argparse
import subprocess
from pathlib import Path
from typing import Any

from reflest_core.parameter import ParameterError

ALL_MODELS = ("hemicnn", "grouplet-fast", "grouplet-slow")


def add_parser(subparsers: Any) -> None:
    """Add the subcommand."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "evaluate", help="normalised RMSE of the networks on SynBRDF splits, as JSON and Markdown"
    )
    parser.add_argument("data", type=Path, help="folder written by 'reflest synbrdf generate'")
    parser.add_argument("--out", type=Path, required=True, help="folder for accuracy.{json,md}")
    parser.add_argument("--model", choices=ALL_MODELS, nargs="+", default=list(ALL_MODELS))
    parser.add_argument(
        "--also", metavar="MODEL=FILE", nargs="+", default=[], help="rows for other weight files"
    )
    parser.add_argument("--split", nargs="+", default=["validation", "unseen"])
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Evaluate every model on every split and write the report."""
    from tqdm import tqdm

    from reflest_core.models.predictor import Predictor
    from reflest_core.training.evaluation import evaluate, guess_the_mean
    from reflest_core.training.report import write_report
    from reflest_core.training.sample import load_samples
    from reflest_core.training.scatter_plot import draw_scatter

    predictors = {}
    for model in arguments.model:
        predictor = Predictor(model)
        predictors[predictor.model_id] = predictor
    for model, file in map(_model_and_file, arguments.also):
        predictors[f"{model} ({file.stem})"] = Predictor(model, file)
    evaluations = []
    for split in arguments.split:
        samples = load_samples(arguments.data, split)
        evaluations.append(guess_the_mean(next(iter(predictors.values())), samples, split))
        for name, predictor in predictors.items():
            with tqdm(total=len(samples), desc=f"{name} on {split}") as bar:
                evaluations.append(evaluate(predictor, samples, split, bar.update, name))
    provenance = {
        "command": f"reflest evaluate DATA --out {arguments.out}",
        "commit": _commit(),
        "data": _describe(arguments.data),
    }
    write_report(arguments.out, evaluations, provenance)
    draw_scatter(arguments.out / "accuracy.png", evaluations)
    print(arguments.out / "accuracy.md")
    return 0


def _model_and_file(given: str) -> tuple[str, Path]:
    model, _, file = given.partition("=")
    if model not in ALL_MODELS or not file:
        raise ParameterError(f"--also {given}: give MODEL=FILE with one of {', '.join(ALL_MODELS)}")
    return model, Path(file)


def _commit() -> str:
    """The checkout's commit, or where the package came from if it is none."""
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "--short", "HEAD"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    return result.stdout.strip() or "unknown (not a git checkout)"


def _describe(data: Path) -> str:
    """The manifest's own command or seed."""
    import json

    manifest = json.loads((data / "manifest.json").read_text())
    environments, meshes = len(manifest["environments"]), len(manifest["meshes"])
    return f"SynBRDF seed {manifest['seed']}, {environments} environments, {meshes} meshes"
