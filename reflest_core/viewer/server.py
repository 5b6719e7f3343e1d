# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Serves the page until it is interrupted."""

from __future__ import annotations

import contextlib
import io
import logging
import socket
import threading
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.export.libraries import library
from reflest_core.viewer.page import Page
from reflest_core.viewer.source import ScanSource, ViewerError

LOOPBACK, PORT = "127.0.0.1", 8770
"""Where the page is by default: nobody else on the network sees it."""
LOOK_S = 0.2
"""Between two looks at the source's state."""


class ViewerServer:
    """A web server with a page for each visitor."""

    def __init__(
        self,
        source: ScanSource,
        host: str = LOOPBACK,
        port: int = PORT,
        light_of_file: NDArray[np.float32] | None = None,
    ) -> None:
        """Begin to serve.

        Args:
            source: of the scan; it stays the caller's to close.
            host: address to listen at; 0.0.0.0 for the whole network.
            port: 0 takes a free one.
            light_of_file: (H, 2 H, 3) equirectangular radiance that visitors may choose, or None.

        Raises:
            ViewerError: The extra ``viewer`` is not installed, or the address cannot be used.
        """
        viser = library("viser", "viewer")
        library("trimesh", "viewer")
        port = _free_port(host, port)
        logging.getLogger("websockets").setLevel(logging.CRITICAL)
        self._source, self._light = source, light_of_file
        self._pages: dict[int, Page] = {}
        self._stopping = threading.Event()
        # A visitor may leave while his page is being drawn.
        warnings.filterwarnings("ignore", "Queued a .* on a closed connection")
        with contextlib.redirect_stdout(io.StringIO()):
            self._server = viser.ViserServer(host, port, label="reflest", verbose=False)
        self.url = f"http://{'127.0.0.1' if host == '0.0.0.0' else host}:{port}"
        self._server.scene.set_up_direction(source.up)
        self._server.gui.configure_theme(
            show_logo=False, show_share_button=False, dark_mode=True, brand_color=(0, 114, 178)
        )
        self._server.gui.set_panel_label(source.name)
        self._server.on_client_connect(self._come)
        self._server.on_client_disconnect(self._leave)
        self._thread = threading.Thread(target=self._look_on, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End serving; visitors' pages say that the connection is lost."""
        self._stopping.set()
        self._thread.join()
        for page in list(self._pages.values()):
            page.close()
        with contextlib.redirect_stdout(io.StringIO()):
            self._server.stop()

    def _come(self, client: Any) -> None:
        self._pages[client.client_id] = Page(client, self._source, self._light)

    def _leave(self, client: Any) -> None:
        page = self._pages.pop(client.client_id, None)
        if page is not None:
            page.close()

    def _look_on(self) -> None:
        while not self._stopping.wait(LOOK_S):
            for page in list(self._pages.values()):
                page.update()


def serve(server: ViewerServer, say: Callable[[str], None]) -> None:
    """Say where the page is, and wait for Ctrl-C.

    Args:
        server: that has begun; it is stopped.
        say: is given sentences.
    """
    say(f"open {server.url} in a browser; Ctrl-C ends")
    try:
        threading.Event().wait()
    except KeyboardInterrupt:
        say("ended")
    finally:
        server.stop()


def _free_port(host: str, port: int) -> int:
    """The port, or a free one for 0; viser itself would silently take the next free one."""
    try:
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        with socket.socket(family, socket.SOCK_STREAM) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((host, port))
            found: int = probe.getsockname()[1]
            return found
    except (OSError, OverflowError) as error:
        reason = getattr(error, "strerror", None) or error
        raise ViewerError(
            f"the page cannot be served at {host}, port {port}: {reason}; "
            "choose another with --host and --port"
        ) from None
