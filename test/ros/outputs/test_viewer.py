# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The page of a running node: what it shows is what was published, its buttons are services."""

from __future__ import annotations

import re

import pytest

from reflest_ros.msg import MaterialMap
from reflest_ros.srv import Estimate
from test.web.browser import opened, still

PATIENCE = 300_000
"""Milliseconds: a machine that runs other tests as well draws slowly."""


@pytest.fixture(scope="module")
def viewer(start, peer, feed):
    """The viewer of a node that has scanned, and the last map that it published."""
    viewer = start("reflest_ros.viewer", "--ros-args", "-p", "port:=0")
    viewer.wait_for_line("open http://", 60.0)
    peer.has_subscriber("/reflectance/materials")
    maps = peer.listen(MaterialMap, "/reflectance/materials")
    for _ in range(8):
        feed.send_good()
    assert peer.call(Estimate, "estimate").success
    peer.wait_until(lambda: maps and maps[-1].materials, "no materials came")
    return viewer, maps


@pytest.fixture(scope="module")
def page(viewer):
    url = re.search(r"http://[\d.:]+", viewer[0].output)[0]
    with opened(url) as (tab, complaints):
        tab.get_by_text("voxels").first.wait_for(timeout=PATIENCE)
        yield tab, complaints


def test_the_page_shows_what_was_published(viewer, page):
    tab, complaints = page
    still(tab, lambda picture: (picture > 60).mean() > 0.02)
    tab.mouse.click(640, 430)
    tab.locator(".reflest-values").wait_for(timeout=PATIENCE)
    shown = int(re.search(r"Material (\d+)", tab.locator("body").inner_text())[1])
    material = next(one for one in viewer[1][-1].materials if one.id == shown)
    rows = tab.locator(".reflest-values tr").all_inner_texts()
    for row, value in zip(
        rows,
        (*material.estimate.rho_d, material.estimate.rho_s, material.estimate.alpha),
        strict=True,
    ):
        assert f"{value:.3f}" in row
    assert complaints == []


def test_its_buttons_call_the_services(viewer, page):
    tab, _ = page
    tab.get_by_role("button", name="Export").click()
    tab.get_by_text(re.compile(r"wrote .*viewer_.*\.glb")).wait_for(timeout=PATIENCE)
    tab.get_by_role("button", name="Scan only here").click()
    tab.get_by_text("a new scan begins, with a sphere").wait_for(timeout=PATIENCE)
    tab.get_by_text("has no materials yet").wait_for(timeout=PATIENCE)


def test_a_signal_ends_it_without_a_traceback(viewer):
    process, _ = viewer
    process.interrupt()
    assert process.exit_code() == 0
    assert "Traceback" not in process.output


def test_wrong_parameters_end_in_one_sentence(start):
    viewer = start("reflest_ros.viewer", "--ros-args", "-p", "up:=[0.0, 0.0, 0.0]")
    assert viewer.exit_code() == 2
    assert "is no direction" in viewer.output
