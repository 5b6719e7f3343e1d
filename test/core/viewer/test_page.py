# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The page in a real browser: a capture is scanned, clicked on, exported."""

import re
from pathlib import Path

import numpy as np
import pytest

from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.settings import CaptureSettings
from reflest_core.errors import ReflestError
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.fusion.settings import RegionSettings
from reflest_core.viewer.capture_source import CaptureSource
from reflest_core.viewer.server import ViewerServer
from test.waiting import wait_until
from test.web.browser import opened, still

CAPTURE = Path(__file__).parents[3] / "captures" / "glossy-red"
MIDDLE = (640, 430)
PATIENCE = 300_000
"""Milliseconds: a machine that runs other tests as well draws slowly."""
LONGEST_SCAN = 600.0
"""Seconds after which something is broken."""
BACKGROUND = 24
"""8-bit level below which a pixel is the page's dark background."""


@pytest.fixture(scope="module")
def source():
    settings = ReflestSettings(region=RegionSettings("sphere", (0.0, 0.0, 0.12), (0.5,) * 3))
    source = CaptureSource(
        CAPTURE, settings, lambda _: open_capture(CAPTURE, settings=CaptureSettings())
    )
    yield source
    source.close()


@pytest.fixture(scope="module")
def scan(source):
    wait_until(lambda: not source.state().is_working, "the scan does not end", LONGEST_SCAN)
    scan = source.state().scan
    assert scan is not None, source.state().progress
    return scan


@pytest.fixture(scope="module")
def page(source, scan):
    server = ViewerServer(source, port=0)
    with opened(server.url) as (page, complaints):
        page.get_by_text("voxels").first.wait_for(timeout=PATIENCE)
        yield page, complaints
    server.stop()


def drawn(page):
    """Share of the middle of the page that is not background, when something is; the picture."""
    picture = still(page, lambda picture: share_drawn(picture) > 0.01)
    return share_drawn(picture), picture


def share_drawn(picture):
    return float((picture.max(axis=-1) > BACKGROUND + 16).mean())


def test_the_surface_is_drawn_in_its_colour(page, scan):
    share, picture = drawn(page[0])
    assert share > 0.1
    red, green, blue = picture[picture.max(axis=-1) > 80].mean(axis=0)
    assert red > 1.3 * max(green, blue)


def test_a_click_shows_the_estimate(page, scan):
    tab, _ = page
    drawn(tab)
    tab.mouse.click(*MIDDLE)
    tab.locator(".reflest-values").wait_for(timeout=PATIENCE)
    estimate = scan.found.materials[0].estimate
    expected = [*estimate.rho_d, estimate.rho_s, estimate.alpha]
    deviations = [*estimate.rho_d_stddev, estimate.rho_s_stddev, estimate.alpha_stddev]
    rows = tab.locator(".reflest-values tr").all_inner_texts()
    numbers = [re.findall(r"\d\.\d{3}", row) for row in rows]
    assert numbers == [
        [f"{value:.3f}", f"{stddev:.3f}"]
        for value, stddev in zip(expected, deviations, strict=True)
    ]
    assert tab.locator(".reflest-plot circle").count() > 5
    assert tab.get_by_text("Material 1").count()


def test_a_key_changes_the_colours(page):
    tab, _ = page
    _, before = drawn(tab)
    tab.keyboard.press("6")
    tab.get_by_text("no material yet").wait_for(timeout=PATIENCE)

    def is_changed(after):
        surface = after.max(axis=-1) > 80
        return surface.any() and np.abs(before - after)[surface].mean() > 20

    still(tab, is_changed)
    tab.keyboard.press("1")
    tab.get_by_text("Rendered by the Ward model").wait_for(timeout=PATIENCE)


def test_the_scan_can_be_scrubbed(page, source):
    tab, _ = page
    assert len(source.state().keyframes) > 3
    last = len(source.state().keyframes)
    whole, _ = drawn(tab)
    field = tab.locator(f"input[value='{last}']").last.element_handle()
    field.fill("0")
    field.press("Enter")
    tab.get_by_text(f"Keyframe 1 of {last}").wait_for(timeout=PATIENCE)
    still(tab, lambda picture: 0.1 * whole < share_drawn(picture) < 0.95 * whole)
    field.fill(str(last))
    field.press("Enter")
    tab.get_by_text(f"Keyframe 1 of {last}").wait_for(state="hidden", timeout=PATIENCE)
    still(tab, lambda picture: share_drawn(picture) > 0.95 * whole)


def test_nothing_fails_in_the_browser(page):
    _, complaints = page
    assert complaints == []


def test_an_export_comes_as_files(source, scan):
    outcome = source.export("glb")
    (name,) = outcome.files
    assert name == "glossy-red.glb"
    assert outcome.files[name][:4] == b"glTF"
    (archive,) = source.export("obj").files
    assert archive == "glossy-red-obj.zip"


def test_a_saved_scan_shows_the_same_materials_and_cannot_be_scanned_again(source, scan, tmp_path):
    (content,) = source.save().files.values()
    path = tmp_path / "saved.npz"
    path.write_bytes(content)
    saved = CaptureSource(path, ReflestSettings(), None)
    try:
        wait_until(lambda: not saved.state().is_working, "it is not read", LONGEST_SCAN)
        again = saved.state().scan.found.materials[0].estimate
        assert again.rho_d == scan.found.materials[0].estimate.rho_d
        with pytest.raises(ReflestError, match="saved scan"):
            saved.set_region((0.0, 0.0, 0.0), 0.1)
    finally:
        saved.close()


def test_a_port_in_use_is_named_in_one_sentence(source):
    server = ViewerServer(source, port=0)
    try:
        with pytest.raises(ReflestError, match=r"port \d+: .*--port"):
            ViewerServer(source, port=int(server.url.rsplit(":", 1)[1]))
    finally:
        server.stop()


def test_a_smaller_region_scans_less(source, scan):
    before = source.state().scan.found.surface.voxel_count
    x, y, z = scan.vertices[0].tolist()
    source.set_region((x, y, z), 0.04)
    wait_until(lambda: not source.state().is_working, "the scan does not end", LONGEST_SCAN)
    assert 0 < source.state().scan.found.surface.voxel_count < before / 2
