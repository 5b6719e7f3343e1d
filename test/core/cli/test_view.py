# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest view``: what the command says before and after the page."""

from pathlib import Path

import pytest

from reflest_core.cli.main import main
from reflest_core.cli.scan_options import CAPTURE_OPTIONS

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


NUMBERS = {"roi-box": 6, "roi-sphere": 4, "roi-pixel": 4, "intrinsics": 4}


@pytest.mark.parametrize("option", CAPTURE_OPTIONS)
@pytest.mark.parametrize("command", [["view"], ["export", "--format", "hdr", "--out", "a.hdr"]])
def test_an_option_of_scanning_is_refused_for_a_saved_scan(command, option, capsys, tmp_path):
    (tmp_path / "scan.npz").touch()
    values = ["1"] * NUMBERS.get(option, 1)
    assert main([*command, str(tmp_path / "scan.npz"), f"--{option}", *values]) == 2
    assert f"--{option} only applies to a capture" in capsys.readouterr().err


def test_values_of_scanning_in_a_config_are_named_for_a_saved_scan(capsys, tmp_path):
    scan, config = tmp_path / "scan.npz", tmp_path / "config.yaml"
    scan.touch()
    config.write_text(
        "/**: {ros__parameters: {fusion: {voxel_size: 0.01, threads: 1}, capture.use_mask: true}}"
    )
    export = ["export", str(scan), "--format", "hdr", "--out", str(tmp_path / "a.hdr")]
    assert main([*export, "--config", str(config)]) == 2
    warning, error = capsys.readouterr().err.splitlines()
    assert f"capture.use_mask, fusion.voxel_size in {config}: not used" in warning
    assert "not a scan" in error


@pytest.mark.parametrize(
    ("option", "numbers", "sentence"),
    [
        ("--roi-sphere", "0 0 0 0", "--roi-sphere: radius = 0 m"),
        ("--roi-sphere", "0 0 0 -1", "--roi-sphere: radius = -1 m"),
        ("--roi-box", "0 0 0 1 0 1", "--roi-box: its two corners"),
        ("--roi-pixel", "0 1 1 0", "--roi-pixel: the radius is 0 m"),
    ],
)
def test_a_region_without_room_is_refused_in_the_words_that_were_typed(
    option, numbers, sentence, capsys
):
    assert main(["replay", str(CAPTURE), option, *numbers.split()]) == 2
    assert sentence in capsys.readouterr().err
