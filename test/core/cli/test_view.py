# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest view``: what the command says before and after the page."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from reflest_core.cli.main import main

ROOT = Path(__file__).parents[3]
CAPTURE = ROOT / "captures" / "glossy-red"


def test_ctrl_c_ends_it_cleanly():
    command = [sys.executable, "-m", "reflest_core.cli.main", "view", str(CAPTURE), "--port", "0"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    view = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    )
    try:
        assert "open http://127.0.0.1:" in view.stdout.readline()
        view.send_signal(signal.SIGINT)
        rest, errors = view.communicate(timeout=60)
    finally:
        view.kill()
    assert "ended" in rest
    assert errors == ""
    assert view.returncode == 0


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["nothing"], "nothing does not exist"),
        ([str(CAPTURE), "--environment", "dark.hdr"], "dark.hdr does not exist"),
        ([str(CAPTURE), "--port", "99999"], "port 99999"),
        ([str(CAPTURE), "--host", "no.such.host.invalid", "--port", "0"], "no.such.host.invalid"),
    ],
)
def test_a_mistake_is_one_sentence(words, sentence, capsys):
    assert main(["view", *words]) == 2
    assert sentence in capsys.readouterr().err
