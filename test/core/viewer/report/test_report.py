# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The report is one page that opens without a network and shows the estimate."""

import base64
import re
from pathlib import Path

import cv2
import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.cli.main import main
from reflest_core.rendering.material_labels import OPACITY, material_colour
from reflest_core.viewer.report.document import report
from reflest_core.viewer.shown_scan import ShownScan
from test.core.export.scanned_ball import RED_ID, STRIPED_ID, scanned_ball
from test.core.fusion.analytic_scene import orbit_frames
from test.web.browser import opened, screenshot

CAPTURE = Path(__file__).parents[4] / "captures" / "glossy-red"
BACKGROUND = (22, 22, 22)


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    scan = ShownScan.of(*scanned_ball(), (0.0, 0.0, 1.0))
    content = report(scan, "<ball>", orbit_frames(3)[0], "24 frames", ["the poses & depths differ"])
    path = tmp_path_factory.mktemp("report") / "ball.html"
    path.write_bytes(content)
    return path


def test_the_page_names_no_address(page):
    text = page.read_text("utf-8")
    assert re.findall(r"(?:src|href)=['\"](?!data:)", text) == []
    assert not re.search(r"https?://|@import|url\(", text)


def test_names_and_sentences_are_escaped(page):
    text = page.read_text("utf-8")
    assert "&lt;ball&gt;" in text
    assert "<ball>" not in text
    assert "poses &amp; depths" in text


def test_ids_and_albedo_lie_over_the_photograph(page):
    text = page.read_text("utf-8")
    labels, albedo = (
        cv2.imdecode(np.frombuffer(base64.b64decode(found), np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
        for found in re.findall(r'over the photograph" src="data:image/jpeg;base64,([^"]+)"', text)
    )
    photograph = orbit_frames(3)[0].rgb
    assert labels.shape == albedo.shape == photograph.shape
    _, found = scanned_ball()
    red = 255 * srgb.encode(np.array(found.material(RED_ID).estimate.rho_d))
    is_red = np.abs(albedo.astype(int) - red).max(axis=2) < 25
    assert 0.005 < is_red.mean() < 0.5
    expected = photograph + OPACITY * (np.array(material_colour(RED_ID)) - photograph.astype(float))
    difference = np.abs(labels[is_red].astype(float) - expected[is_red]).max(axis=1)
    assert (difference < 40).mean() > 0.8


def test_the_same_scan_gives_the_same_bytes(page):
    scan = ShownScan.of(*scanned_ball(), (0.0, 0.0, 1.0))
    again = report(scan, "<ball>", orbit_frames(3)[0], "24 frames", ["the poses & depths differ"])
    assert again == page.read_bytes()


def test_a_browser_draws_the_model_and_finds_the_material_under_a_click(page):
    with opened(page.as_uri()) as (tab, complaints):
        canvas = tab.locator("#model").bounding_box()
        x, y = canvas["x"] + canvas["width"] / 2, canvas["y"] + canvas["height"] / 2
        picture = screenshot(tab)
        inside = picture[int(y) - 100 : int(y) + 100, int(x) - 100 : int(x) + 100]
        assert (inside != BACKGROUND).any(axis=-1).mean() > 0.3
        for offset, material in ((-0.2, RED_ID), (0.2, STRIPED_ID)):
            # A click may scroll the page to the material's row; this one waits until it rests.
            place = {"x": canvas["width"] / 2, "y": (0.5 + offset) * canvas["height"]}
            tab.locator("#model").click(position=place)
            assert tab.locator("tr.chosen").get_attribute("data-material") == str(material)
        red = scanned_ball()[1].material(RED_ID).estimate
        row = tab.locator(f"tr[data-material='{RED_ID}']").inner_text()
        for value in (*red.rho_d, red.rho_s, red.alpha):
            assert f"{value:.3f}" in row
        tab.select_option("#mode", "Roughness alpha")
        assert not (screenshot(tab) == picture).all()
        assert complaints == []


def test_replay_writes_it(tmp_path, capsys):
    path = tmp_path / "out.html"
    roi = ["--roi-pixel", "0", "160", "120", "0.2"]
    assert main(["replay", str(CAPTURE), "--report", str(path), *roi]) == 0
    assert "Materials of glossy-red" in path.read_text("utf-8")
    capsys.readouterr()
