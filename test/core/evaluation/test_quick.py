# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The shipped weights repeat a row of Table 2 on the shipped validation scenes."""

import subprocess
import sys
from pathlib import Path

from reflest_core.cli.main import main
from reflest_core.evaluation.quick_check import EXPECTED, QUICK_SET


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
        [sys.executable, "-c", script], cwd=root, capture_output=True, text=True, timeout=240
    )
    return done.returncode, done.stdout + done.stderr


def test_the_row_needs_no_pytorch():
    code, output = without_torch("evaluate", "--quick")
    assert code == 0, output


def test_training_without_pytorch_says_what_to_install(tmp_path):
    code, output = without_torch("train", "data", "--all", "--out", str(tmp_path))
    assert code == 2
    assert "needs torch, which is not installed: install reflest's extra 'training'" in output
