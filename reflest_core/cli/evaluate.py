"""``reflest evaluate``: what the shipped (or given) weights reach on SynBRDF splits."""

from __future__ import annotations

import argparse
import subprocess
from pathlib import Path
from typing import Any

ALL_MODELS = ("hemicnn", "grouplet-fast", "grouplet-slow")


def add_parser(subparsers: Any) -> None:
    """Add the subcommand."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "evaluate", help="normalised RMSE of the networks on SynBRDF splits, as JSON and Markdown"
    )
    parser.add_argument("data", type=Path, help="folder written by 'reflest synbrdf generate'")
    parser.add_argument("--out", type=Path, required=True, help="folder for accuracy.{json,md}")
    parser.add_argument("--model", choices=ALL_MODELS, nargs="+", default=list(ALL_MODELS))
    parser.add_argument("--weights", type=Path, help="weight file in place of the shipped one")
    parser.add_argument("--split", nargs="+", default=["validation", "unseen"])
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Evaluate every model on every split and write the report."""
    from tqdm import tqdm

    from reflest_core.models.predictor import Predictor
    from reflest_core.training.evaluation import evaluate, guess_the_mean
    from reflest_core.training.report import write_report
    from reflest_core.training.sample import load_samples

    predictors = [Predictor(model, arguments.weights) for model in arguments.model]
    evaluations = []
    for split in arguments.split:
        samples = load_samples(arguments.data, split)
        evaluations.append(guess_the_mean(predictors[0], samples, split))
        for predictor in predictors:
            with tqdm(total=len(samples), desc=f"{predictor.model_id} on {split}") as bar:
                evaluations.append(evaluate(predictor, samples, split, bar.update))
    options = f" --weights {arguments.weights.name}" if arguments.weights else ""
    provenance = {
        "command": f"reflest evaluate DATA --out {arguments.out}{options}",
        "commit": _commit(),
        "data": _describe(arguments.data),
    }
    write_report(arguments.out, evaluations, provenance)
    print(arguments.out / "accuracy.md")
    return 0


def _commit() -> str:
    """The checkout's commit, or where the package came from if it is none."""
    command = ["git", "-C", str(Path(__file__).parent), "rev-parse", "--short", "HEAD"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    return result.stdout.strip() or "unknown (not a git checkout)"


def _describe(data: Path) -> str:
    """The manifest's own command or seed."""
    import json

    manifest = json.loads((data / "manifest.json").read_text())
    return f"SynBRDF seed {manifest['seed']}"
