# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest view``: what the command says before and after the page."""

from pathlib import Path

import pytest

from reflest_core.cli.main import main

ROOT = Path(__file__).parents[3]
CAPTURE = ROOT / "captures" / "glossy-red"


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
