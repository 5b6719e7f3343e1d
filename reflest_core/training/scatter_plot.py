"""Estimates against truths, one panel for each parameter and split."""

from __future__ import annotations

from pathlib import Path

from reflest_core.training.evaluation import Evaluation
from reflest_core.training.sample import TrainingError

PANELS = (("rho_d (r, g, b)", (0, 1, 2)), ("rho_s", (3,)), ("alpha", (4,)))
CHANNEL_COLOURS = ("#c23b3b", "#3b8f3b", "#3b5fc2")


def draw_scatter(path: Path, evaluations: list[Evaluation]) -> None:
    """Draw the network that is best on the last split; the diagonal is a perfect estimate.

    The first evaluation of each split is guessing the mean.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise TrainingError("the plot needs matplotlib: pip install matplotlib") from error
    splits = list(dict.fromkeys(evaluation.split for evaluation in evaluations))
    last = [evaluation for evaluation in evaluations if evaluation.split == splits[-1]]
    best = min(last[1:], key=lambda evaluation: evaluation.ward.overall).model
    figure = Figure(figsize=(11, 3.6 * len(splits)), layout="constrained")
    figure.suptitle(best)
    axes = figure.subplots(len(splits), len(PANELS), squeeze=False)
    for row, split in enumerate(splits):
        shown = next(e for e in evaluations if (e.split, e.model) == (split, best))
        for column, (name, indices) in enumerate(PANELS):
            panel = axes[row, column]
            top = float(shown.truths[:, indices].max())
            panel.plot([0, top], [0, top], color="0.7", linewidth=1)
            for index in indices:
                colour = CHANNEL_COLOURS[index] if index < 3 else "0.2"
                panel.scatter(
                    shown.truths[:, index], shown.estimates[:, index], s=7, color=colour, alpha=0.6
                )
            panel.set(xlabel="truth", ylabel="estimate", title=f"{name}, {split}")
    figure.savefig(path, dpi=90)
