# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The ablation's table holds what the trainings measured, beside the whole network."""

import json

import pytest

from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.sections.ablations import ablation
from reflest_core.evaluation.studies.ablation import collect_ablation


def write_run(folder, name, without, errors):
    """A training's figures with the given RMSE on held-out scenes by views; validation half."""

    def figures(rmse):
        return {"rmse": rmse, "rmse_per_parameter": [rmse] * 4 + [2 * rmse]}

    recipe = {
        "without": without,
        "minibatches": 500,
        "hold_out": ["city", "forest"],
        "data": {"train_looks": 80},
    }
    splits = {
        "held_out": {views: figures(rmse) for views, rmse in errors.items()},
        "validation": {views: figures(rmse / 2) for views, rmse in errors.items()},
    }
    (folder / name).mkdir(parents=True)
    (folder / name / "held_out.json").write_text(json.dumps({"recipe": recipe, "splits": splits}))


def test_the_whole_comes_first_and_then_what_costs_most_last(tmp_path):
    write_run(tmp_path, "a", ["light"], {"100": 0.7, "10": 0.9})
    write_run(tmp_path, "b", ["shares", "fit"], {"100": 0.5, "10": 0.6})
    write_run(tmp_path, "c", [], {"100": 0.3, "10": 0.4})
    record = collect_ablation(tmp_path)
    assert [run["without"] for run in record["runs"]] == ["nothing", "shares and fit", "light"]
    page = "\n".join(ablation(record))
    assert "| light | 0.700 (+0.400) | 0.900 (+0.500) | 0.350 (+0.200) | 0.450 (+0.250) |" in page
    assert "| nothing | 0.300 (+0.000) | 0.400 (+0.000) |" in page
    assert "0.600 | 500 |" in page
    assert "the environments city, forest held out" in page
    assert "- *light*: " in page


def test_trainings_that_held_nothing_out_do_not_count(tmp_path):
    write_run(tmp_path, "whole", [], {"100": 0.3})
    path = tmp_path / "whole" / "held_out.json"
    figures = json.loads(path.read_text())
    del figures["splits"]["held_out"]
    path.write_text(json.dumps(figures))
    with pytest.raises(EvaluationError, match="holds no whole lightnet to compare with"):
        collect_ablation(tmp_path)


def test_a_damaged_record_is_named(tmp_path):
    write_run(tmp_path, "whole", [], {"100": 0.3})
    (tmp_path / "whole" / "held_out.json").write_text("{")
    with pytest.raises(EvaluationError, match=r"held_out\.json is damaged"):
        collect_ablation(tmp_path)
