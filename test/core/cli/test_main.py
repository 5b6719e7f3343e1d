# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The installed command as a user runs it: exit codes, one-line errors, no traceback."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from reflest_core.cli.main import COMMANDS
from reflest_core.estimation.settings import EstimationSettings

CHECKOUT = Path(__file__).parents[3]


def reflest(*arguments, code=None):
    command = ["-c", code] if code else ["-m", "reflest_core.cli.main", *map(str, arguments)]
    return subprocess.run(
        [sys.executable, *command], capture_output=True, text=True, cwd=CHECKOUT, timeout=600
    )


def test_two_runs_write_the_same_bytes(weights, bag, tmp_path):
    outputs = []
    for name in ("a.json", "b.json"):
        done = reflest("replay", bag, "--weights", weights, "--json", tmp_path / name)
        assert done.returncode == 0, done.stderr
        assert "final" in done.stdout
        outputs.append((tmp_path / name).read_bytes())
    assert outputs[0] == outputs[1]
    assert json.loads(outputs[0])["model"] == EstimationSettings().model


def test_what_does_not_exist_ends_with_one_line():
    done = reflest("replay", "nowhere.mcap")
    assert done.returncode == 2
    assert done.stderr == "reflest: error: nowhere.mcap does not exist\n"


def test_help_starts_without_the_heavy_libraries():
    done = reflest(
        code="import sys; from reflest_core.cli.main import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        "print('HEAVY', {'torch', 'open3d', 'cv2', 'mitsuba', 'numba'} & set(sys.modules))"
    )
    assert "HEAVY set()" in done.stdout
    for command in COMMANDS:
        assert command in done.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ["train", "data", "--model", "hemicnn", "--out", "out"],
        ["evaluate", ".", "--out", "out"],
    ],
)
def test_training_without_pytorch_ends_with_the_extra_that_brings_it(arguments):
    done = reflest(
        code="import sys; from reflest_core.cli.main import main\n"
        f"sys.modules['torch'] = None; sys.exit(main({arguments}))"
    )
    assert done.returncode == 2
    assert done.stderr == (
        "reflest: error: this command needs torch, which is not installed: "
        "pip install 'reflest-ros[training]'\n"
    )


def test_replay_needs_no_pytorch(bag, weights):
    done = reflest(
        code="import sys; from reflest_core.cli.main import main\n"
        "sys.modules['torch'] = None\n"
        f"sys.exit(main(['replay', {str(bag)!r}, '--weights', {str(weights)!r}]))"
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "arguments", [[], ["replay"], ["nonsense"], ["replay", "x", "--roi-box", "1"]]
)
def test_a_wrong_command_line_is_one_line_that_names_the_help(arguments):
    done = reflest(*arguments)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert line.startswith("reflest")
    assert ": error: " in line
    assert line.endswith("--help`)")


def test_a_reader_that_leaves_is_no_error(weights, bag):
    command = [sys.executable, "-m", "reflest_core.cli.main", "replay", bag, "--weights", weights]
    process = subprocess.Popen(
        list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=CHECKOUT
    )
    process.stdout.close()
    errors = process.stderr.read().decode()
    assert process.wait(timeout=600) == 1
    assert "Traceback" not in errors
    process.stderr.close()
