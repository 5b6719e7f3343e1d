# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``--roi-pixel``: a region by what a pixel shows."""

from pathlib import Path

import numpy as np
import pytest

from reflest_core.capture.open_capture import open_capture
from reflest_core.cli.main import command_parser, main
from reflest_core.cli.scan_settings import scan_settings

CAPTURE = Path(__file__).parents[3] / "captures" / "glossy-red"


def settings(*words):
    options = command_parser(["replay"]).parse_args(["replay", str(CAPTURE), "--roi-pixel", *words])
    return scan_settings(options)


def with_depth(frame):
    rows, columns = np.nonzero(frame.depth > 0)
    middle = len(rows) // 2
    return int(columns[middle]), int(rows[middle])


def test_the_sphere_lies_around_what_the_pixel_shows():
    frame = list(open_capture(CAPTURE))[2]
    u, v = with_depth(frame)
    region = settings("2", str(u), str(v), "0.07").region
    assert region.shape == "sphere"
    assert region.size == (0.14, 0.14, 0.14)
    centre = np.linalg.inv(frame.T_world_camera) @ np.append(region.centre, 1.0)
    pixel = frame.intrinsics.matrix @ centre[:3]
    assert pixel[:2] / pixel[2] == pytest.approx([u, v])
    assert pixel[2] == pytest.approx(float(frame.depth[v, u]))


def without_depth():
    frame = next(iter(open_capture(CAPTURE)))
    rows, columns = np.nonzero(frame.depth == 0)
    return ["0", str(columns[0]), str(rows[0]), "0.1"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["999", "10", "10", "0.1"], "no frame 999"),
        (["0.5", "10", "10", "0.1"], "frame 0.5"),
        (["nan", "10", "10", "0.1"], "frame nan is no whole number"),
        (["inf", "10", "10", "0.1"], "frame inf is no whole number"),
        (["0", "nan", "10", "0.1"], "pixel nan 10 is not finite"),
        (["0", "10", "inf", "0.1"], "pixel 10 inf is not finite"),
        (["0", "-1", "10", "0.1"], "pixel -1 10 is not in the image"),
        (["0", "10", "9999", "0.1"], "pixel 10 9999 is not in the image"),
        (["0", "10", "10", "0"], "radius is 0 m"),
        (["0", "10", "10", "nan"], "radius is nan m"),
        (without_depth, "has no depth at pixel"),
    ],
)
def test_what_cannot_be_is_named(words, sentence, capsys):
    words = words() if callable(words) else words
    assert main(["replay", str(CAPTURE), "--roi-pixel", *words]) == 2
    assert sentence in capsys.readouterr().err
