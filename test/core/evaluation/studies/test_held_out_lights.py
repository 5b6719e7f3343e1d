# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Errors are listed by held-out light; no light has a part in calibrating its own intervals."""

import numpy as np
import pytest

from reflest_core.cli.main import main
from reflest_core.evaluation.networks import EvaluationError
from reflest_core.evaluation.sections.held_out import held_out_lights
from reflest_core.evaluation.studies.held_out_lights import measure_held_out_lights
from reflest_core.training.light.measured_scans import MeasuredScans


def training(folder, size, lights, count=2000):
    """One whose errors are ``size`` times what it states, under ``lights`` in turn."""
    folder.mkdir()
    rng = np.random.default_rng(len(lights) + int(10 * size))
    deviations = rng.uniform(0.1, 1.0, (count, 5))
    measured = MeasuredScans(
        size * deviations * rng.normal(size=(count, 5)),
        deviations,
        np.tile([100, 10], count // 2),
        np.array(lights)[np.arange(count) // 2 % len(lights)],
    )
    measured.save(folder)
    return measured


def test_each_is_measured_by_itself_and_calibrated_by_the_others(tmp_path):
    sure = training(tmp_path / "a", 1.0, ["dim", "noon"])
    bold = training(tmp_path / "b", 2.0, ["dawn"])
    record = measure_held_out_lights([tmp_path / "a", tmp_path / "b"])
    found = record["views"]["100"]
    errors = np.concatenate([sure.errors[::2], bold.errors[::2]])
    assert record["lights"] == 3
    assert found["variants"] == 2000
    assert found["rmse"] == pytest.approx(np.sqrt((errors**2).mean()))
    assert found["by_light"]["dawn"] == pytest.approx(np.sqrt((bold.errors[::2] ** 2).mean()))
    assert list(found["by_light"])[-1] == "dawn"
    # Intervals twice as wide as they should be hold 0.999 of a normal's truths, and half as wide
    # ones 0.589: together 0.79. By its own errors each would hold 0.9.
    np.testing.assert_allclose(found["inside"], 0.794, atol=0.03)
    for quarters in found["inside_by_quarter"]:
        np.testing.assert_allclose(quarters, 0.794, atol=0.06)
    page = "\n".join(held_out_lights(record))
    assert f"dawn {found['by_light']['dawn']:.2f}" in page
    assert f"{100 * found['inside'][0]:.0f}" in page


def test_the_command_puts_them_on_the_page(data, tmp_path, capsys):
    training(tmp_path / "a", 1.0, ["dim"])
    training(tmp_path / "b", 2.0, ["dawn"])
    out, part = ["--out", str(tmp_path / "out")], ["--parts", "held-out-lights"]
    assert main(["evaluate", str(data), *out, *part]) == 2
    assert "needs --held-out RUN..." in capsys.readouterr().err
    given = ["--held-out", str(tmp_path / "a"), str(tmp_path / "b")]
    assert main(["evaluate", str(data), *out, *given, *part]) == 0
    page = (tmp_path / "out" / "index.md").read_text()
    assert "## Held-out training environments" in page
    assert ", dawn " in page
    assert "--held-out RUN..." in page


def test_one_training_or_one_light_twice_is_refused(tmp_path):
    training(tmp_path / "a", 1.0, ["dim", "noon"])
    training(tmp_path / "b", 2.0, ["dim"])
    with pytest.raises(EvaluationError, match="two trainings or more"):
        measure_held_out_lights([tmp_path / "a"])
    with pytest.raises(EvaluationError, match="by one training alone"):
        measure_held_out_lights([tmp_path / "a", tmp_path / "b"])
