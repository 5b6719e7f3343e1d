"""The headline figure by hand, and the report that carries it."""

import json

import cv2
import numpy as np
import pytest

from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.models.predictor import Predictor
from reflest_core.training.evaluation import evaluate, guess_the_mean
from reflest_core.training.metrics import normalised_rmse
from reflest_core.training.report import write_report
from reflest_core.training.scatter_plot import draw_scatter
from test.core.training.scenes import learnable_samples


def test_normalised_rmse_by_hand():
    statistics = ParameterStatistics(np.full(5, 0.5), np.array([0.1, 0.1, 0.1, 0.2, 0.2]))
    truths = np.full((2, 5), 0.5)
    estimates = truths.copy()
    estimates[0, 0] += 0.2  # two standard deviations in one of ten values
    rmse = normalised_rmse(estimates, truths, statistics)
    assert rmse.overall == pytest.approx(np.sqrt(4 / 10))
    np.testing.assert_allclose(rmse.per_parameter, [np.sqrt(2), 0, 0, 0, 0])
    assert rmse.scene_mean == pytest.approx(np.sqrt(4 / 5) / 2)
    assert rmse.scene_median == pytest.approx(np.sqrt(4 / 5) / 2)


def test_guessing_the_mean_of_the_training_set_scores_one():
    rng = np.random.default_rng(0)
    truths = rng.random((5000, 5))
    statistics = ParameterStatistics.of(truths)
    guesses = np.tile(statistics.mean, (5000, 1))
    assert normalised_rmse(guesses, truths, statistics).overall == pytest.approx(1)


def test_the_report_holds_every_figure_once_in_json_and_once_on_the_page(tmp_path):
    predictor, samples = Predictor("hemicnn"), learnable_samples(3, 5)
    calls = []
    evaluated = evaluate(predictor, samples, "validation", lambda: calls.append(1))
    guessed = guess_the_mean(predictor, samples, "validation")
    assert len(calls) == 3
    write_report(
        tmp_path, [guessed, evaluated], {"command": "reflest evaluate", "commit": "c", "data": "d"}
    )
    record = json.loads((tmp_path / "accuracy.json").read_text())
    figures = record["evaluations"][1]["ward"]
    assert figures["overall"] == evaluated.ward.overall
    page = (tmp_path / "accuracy.md").read_text()
    assert f"{evaluated.ward.overall:.3f}" in page
    assert predictor.model_id in page
    draw_scatter(tmp_path / "accuracy.png", [guessed, evaluated])
    assert cv2.imread(str(tmp_path / "accuracy.png")).std() > 10
    assert "| 0.419 |" in page
