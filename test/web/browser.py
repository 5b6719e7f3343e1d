# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Pages in headless Chromium; skips where tools are missing."""

import functools
import http.server
import shutil
import subprocess
import threading
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlencode

import cv2
import numpy as np
import pytest

from test.waiting import wait_until

WEB = Path(__file__).parent
MODULES = WEB / "node_modules"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")

SOFTWARE = (
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--force-color-profile=srgb",
)
"""Options that draw WebGL without a graphics card, the same everywhere."""
LONGEST_DRAWING = 300.0
"""Seconds after which something is broken."""
STEP = 0.5
"""Seconds between two pictures, longer than the page takes for one of an idle machine."""


def needs_node():
    if shutil.which("node") is None or not MODULES.is_dir():
        pytest.skip("needs Node and its packages: make web-tools")


def needs_browser():
    needs_node()
    if CHROMIUM is None:
        pytest.skip("needs Chromium: apt-get install chromium")


class Files(http.server.SimpleHTTPRequestHandler):
    """This folder, and another one below ``/files/``."""

    def __init__(self, *arguments, folder, **options):
        self.folder = folder
        super().__init__(*arguments, **options)

    def translate_path(self, path):
        name = path.split("?")[0].lstrip("/")
        if name.startswith("files/"):
            return str(self.folder / name.removeprefix("files/"))
        return str(WEB / name)

    def log_message(self, *_):
        pass


def shown(page, folder, picture, **query):
    """The page's (size, size, 3) sRGB picture in [0, 1]; ``files/`` in its query is ``folder``."""
    needs_browser()
    size = query["size"]
    handler = functools.partial(Files, folder=folder)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_port}/{page}?{urlencode(query)}"
        subprocess.run(
            [
                CHROMIUM,
                "--headless",
                *SOFTWARE,
                f"--window-size={size},{size}",
                "--virtual-time-budget=60000",
                f"--screenshot={picture}",
                address,
            ],
            check=True,
            capture_output=True,
            timeout=600,
        )
        server.shutdown()
    found = cv2.imread(str(picture))
    assert found.shape == (size, size, 3)
    return found[..., ::-1] / 255.0


@contextmanager
def opened(url, width=1280, height=800):
    """The page at an address in headless Chromium, and the list of what its console complained of.

    It is Playwright's page; see https://playwright.dev/python.
    """
    if CHROMIUM is None:
        pytest.skip("needs Chromium: apt-get install chromium")
    api = pytest.importorskip("playwright.sync_api", reason="needs playwright: make set-up")
    complaints = []

    def note(message):
        if message.type == "error":
            complaints.append(message.text)

    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=SOFTWARE)
        page = browser.new_page(viewport={"width": width, "height": height})
        page.on("console", note)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(url)
        try:
            yield page, complaints
        finally:
            browser.close()


def still(page, is_wanted):
    """The (H, W, 3) sRGB middle of the page, values 0 to 255, once it is wanted and rests."""
    seen = [np.zeros(())]

    def rests():
        seen.append(_middle(page))
        return is_wanted(seen[-1]) and np.abs(seen[-1] - seen[-2]).mean() < 0.1

    wait_until(rests, "the page does not come to rest with what is wanted", LONGEST_DRAWING, STEP)
    return seen[-1]


def screenshot(page):
    """What the page shows now, (H, W, 3) sRGB."""
    return cv2.imdecode(np.frombuffer(page.screenshot(), np.uint8), cv2.IMREAD_COLOR)[..., ::-1]


def _middle(page):
    return screenshot(page)[150:, 330:950].astype(float)
