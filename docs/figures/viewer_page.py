# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Takes docs/images/viewer.jpg: the page of ``reflest view`` after a click.

``python docs/figures/viewer_page.py BAG OUT.jpg X Y``, with a bag of ``reflest synbrdf tabletop``
and the click in pixels of the page. Needs the extra viewer, Playwright and Chromium.
"""

from __future__ import annotations

import shutil
import sys
import time
from pathlib import Path

from playwright.sync_api import sync_playwright

from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.viewer.capture_source import CaptureSource
from reflest_core.viewer.server import ViewerServer

WIDTH, HEIGHT, QUALITY = 1280, 760, 82
ARGUMENTS = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
DRAWN_S = 15.0
"""Seconds in which a change is drawn, also without a graphics card."""
PATIENCE = 90_000
"""Milliseconds in which the page must answer."""


def main() -> None:
    """Scan, open, click, look where to go next, take the picture."""
    bag, out, x, y = sys.argv[1:]
    settings = ReflestSettings()
    source = CaptureSource(
        Path(bag), settings, lambda _: open_capture(bag, settings=settings.capture)
    )
    server = ViewerServer(source, port=0)
    while source.state().is_working:
        time.sleep(0.2)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=ARGUMENTS
        )
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
        page.goto(server.url)
        page.locator(".mantine-Notification-closeButton").click()
        time.sleep(DRAWN_S)
        page.mouse.click(float(x), float(y))
        page.locator(".reflest-values").wait_for(timeout=PATIENCE)
        page.keyboard.press("n")
        page.get_by_text("a new direction for").first.wait_for(timeout=PATIENCE)
        time.sleep(DRAWN_S)
        page.screenshot(path=out, type="jpeg", quality=QUALITY)
        browser.close()
    server.stop()
    source.close()


if __name__ == "__main__":
    main()
