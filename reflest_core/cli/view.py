# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``reflest view``: a capture or a saved scan in the browser."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reflest_core.cli.scan_options import (
    add_scan_options,
    check_capture_options,
    check_paths,
    is_saved,
)

if TYPE_CHECKING:
    from reflest_core.capture.capture import Capture
    from reflest_core.estimation.pipeline import Pipeline
    from reflest_core.viewer.capture_source import CaptureSource

EPILOG = """Needs the extra viewer: pip install 'reflest-ros[viewer]'. The page is for this machine
alone unless --host names another address; whoever can open it can scan and export."""


def add_parser(subparsers: Any) -> None:
    """Add the subcommand.

    Args:
        subparsers: the subcommands of ``reflest``.
    """
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "view",
        help="look at a capture or a saved scan in the browser",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("capture", type=Path, metavar="CAPTURE|SCAN")
    parser.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="address to serve at, 0.0.0.0 for the whole network; default: %(default)s, this "
        "machine alone",
    )
    parser.add_argument(
        "--port", type=int, default=8770, help="0 takes a free one; default: %(default)s"
    )
    parser.add_argument(
        "--environment",
        type=Path,
        metavar="FILE",
        help="an .hdr or .exr panorama to show the materials in, beside the built-in lights",
    )
    add_scan_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Serve the page until Ctrl-C.

    Args:
        options: all options of the command.

    Returns:
        The exit code.

    Raises:
        ReflestError: A bad option, an unreadable capture, a missing extra or a port in use.
    """
    check_paths(options, inputs=("environment",))
    check_capture_options(options)
    from reflest_core.export.libraries import library

    library("viser", "viewer")
    from reflest_core.viewer.lights import read_light
    from reflest_core.viewer.server import ViewerServer, serve

    light = None if options.environment is None else read_light(options.environment)
    source = capture_source(options)
    try:
        server = ViewerServer(source, options.host, options.port, light)
        serve(server, lambda sentence: print(f"reflest view: {sentence}", flush=True))
    finally:
        source.close()
    return 0


def capture_source(options: argparse.Namespace) -> CaptureSource:
    """Open what the command line names.

    Args:
        options: all options of the command.

    Raises:
        ReflestError: It cannot be opened.
    """
    from reflest_core.cli.scan_settings import scan_settings
    from reflest_core.cli.source import open_source
    from reflest_core.jit import announce_compilation
    from reflest_core.viewer.capture_source import CaptureSource

    announce_compilation()
    settings, path = scan_settings(options), options.capture
    if is_saved(path):
        return CaptureSource(path, settings, None)

    def open_again(scanner: Pipeline) -> Capture:
        return open_source(
            options, settings.capture, on_clock_jump=lambda _: scanner.restart_clock()
        )

    return CaptureSource(path, settings, open_again)
