# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The shipped weights repeat a row of Table 2 on the shipped validation scenes."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from reflest_core.cli.main import main
from reflest_core.evaluation import quick_check
from reflest_core.evaluation.networks import EvaluationError, network_named
from reflest_core.evaluation.quick_check import EXPECTED, QUICK_SET
from reflest_core.models.predictor import Predictor
from reflest_core.training.data.sample import TrainingError, load_samples
from reflest_core.training.data.sample_file import read_samples


def test_a_row_of_table_2_is_reproduced_from_what_is_shipped(capsys):
    assert main(["evaluate", "--quick"]) == 0
    assert "HemiCNN, RMSE_1" in capsys.readouterr().out


def test_the_quick_set_is_small_and_shipped_with_what_it_must_give():
    assert QUICK_SET.stat().st_size < 6_000_000
    assert EXPECTED.is_file()


def without_torch(*arguments):
    """The command's exit code and output in an interpreter that has no PyTorch."""
    script = (
        "import sys; sys.modules['torch'] = None; from reflest_core.cli.main import main; "
        f"sys.exit(main({list(arguments)!r}))"
    )
    root = Path(__file__).parents[3]
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=root, capture_output=True, text=True, timeout=1100
    )
    return done.returncode, done.stdout + done.stderr


def test_the_row_needs_no_pytorch():
    code, output = without_torch("evaluate", "--quick")
    assert code == 0, output


def test_training_without_pytorch_says_what_to_install(tmp_path):
    code, output = without_torch("train", "data", "--all", "--out", str(tmp_path))
    assert code == 2
    assert "needs torch, which is not installed: pip install 'reflest-ros[training]'" in output


def test_the_quick_set_repeats_estimates_bit_for_bit(data, runs, tmp_path):
    samples = load_samples(data, "validation")
    path = tmp_path / "validation.safetensors"
    quick_check.save_quick_set(path, samples)
    small = read_samples(path)
    predictor = Predictor("hemicnn", runs / "hemicnn-rmse1" / "hemicnn-rmse1.safetensors")
    assert sum(s.surface.voxel_count for s in small) == 25 * len(samples)
    for kept, whole in zip(small, samples, strict=True):
        expected = predictor.predict(whole.surface).ward
        np.testing.assert_array_equal(predictor.predict(kept.surface).ward, expected)
        np.testing.assert_array_equal(kept.ward, whole.ward)
        assert kept.environment == whole.environment


def test_a_damaged_quick_set_is_named(tmp_path):
    path = tmp_path / "validation.safetensors"
    path.write_bytes(b"nothing")
    with pytest.raises(TrainingError, match=r"validation\.safetensors is damaged"):
        read_samples(path)


def test_a_row_that_is_not_reproduced_is_an_error(data, tmp_path):
    path, expected = tmp_path / "validation.safetensors", tmp_path / "expected.json"
    quick_check.save_quick_set(path, load_samples(data, "validation"))
    shipped = network_named(quick_check.find_networks(None), quick_check.VARIANT)
    quick_check.write_expected(shipped, path)
    row = quick_check.reproduce_row(path, expected)
    assert row.accuracy.ward.overall == row.recorded
    record = json.loads(expected.read_text())
    expected.write_text(json.dumps({**record, "rmse": record["rmse"] + 0.01}))
    with pytest.raises(EvaluationError, match="does not estimate as it did"):
        quick_check.reproduce_row(path, expected)
    expected.write_text(json.dumps({**record, "model_id": "hemicnn/0"}))
    with pytest.raises(EvaluationError, match="Table 2 was measured with hemicnn/0"):
        quick_check.reproduce_row(path, expected)
