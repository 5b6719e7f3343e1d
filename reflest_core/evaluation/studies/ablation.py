# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The contribution of each part of lightnet, from the figures of trainings without it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from reflest_core.evaluation.networks import EvaluationError
from reflest_core.training.light.ablation import PARTS
from reflest_core.training.light.task import FIGURES

WHOLE = "nothing"


def collect_ablation(folder: Path) -> dict[str, Any]:
    """Collect the figures of every training of lightnet in a folder.

    Args:
        folder: Holds ``<run>/held_out.json`` for each training.

    Returns:
        The environments that were held out, and ``runs``: the whole lightnet first, then the
        others by their error on held-out environments.

    Raises:
        EvaluationError: there is no whole lightnet to compare with, or a file is damaged.
    """
    found = [_read(path) for path in sorted(folder.glob(f"*/{FIGURES}"))]
    runs = [run for run in found if "held_out" in run["splits"]]
    if not any(run["without"] == WHOLE for run in runs):
        raise EvaluationError(
            f"{folder} holds no whole lightnet to compare with; train one with 'reflest train DATA "
            f"--model lightnet --hold-out ENVIRONMENT ... --out {folder}/whole'"
        )
    runs.sort(key=lambda run: (run["without"] != WHOLE, _first(run["splits"]["held_out"])["rmse"]))
    return {"hold_out": runs[0]["hold_out"], "runs": runs}


def _read(path: Path) -> dict[str, Any]:
    try:
        figures = json.loads(path.read_text())
        recipe = figures["recipe"]
        without = list(recipe["without"])
        return {
            "run": path.parent.name,
            "without": " and ".join(without) or WHOLE,
            "meaning": "; ".join(PARTS[part] for part in without),
            "minibatches": recipe["minibatches"],
            "hold_out": list(recipe["hold_out"]),
            "variants": recipe["data"].get("train_looks"),
            "splits": figures["splits"],
        }
    except (OSError, ValueError, KeyError) as error:
        raise EvaluationError(f"{path} is damaged ({error!r}); train that run again") from error


def _first(by_views: dict[str, Any]) -> dict[str, Any]:
    """The figures of most views."""
    figures: dict[str, Any] = by_views[max(by_views, key=int)]
    return figures
