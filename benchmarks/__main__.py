# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``python -m benchmarks [--quick] [--cache FOLDER] [--output FOLDER] [--capture CAPTURE]``."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from benchmarks.measuring.machine import ROOT
from benchmarks.plan import FULL, QUICK, TINY
from benchmarks.report.page import write_page
from benchmarks.run import run
from reflest_core.errors import ReflestError

PLANS = {"full": FULL, "quick": QUICK, "tiny": TINY}


def main(arguments: list[str] | None = None) -> int:
    """Run the benchmarks and write the page.

    Args:
        arguments: The command line; None for the process's own.

    Returns:
        0 when everything was measured, else 2 after one sentence of error.
    """
    options = parse_arguments(arguments)
    plan = "quick" if options.quick else options.plan
    output = options.output or (ROOT / "docs" if plan == "full" else ROOT / "build" / "benchmarks")
    try:
        page = write_page(run(PLANS[plan], options.cache, options.capture), output)
    except ReflestError as error:
        print(f"reflest: error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    print(page.read_text())
    return 0


def parse_arguments(arguments: list[str] | None) -> argparse.Namespace:
    """Parse the command line.

    Args:
        arguments: The command line; None for the process's own.
    """
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="the same with fewer frames")
    parser.add_argument("--plan", choices=PLANS, default="full", help="how much is measured")
    parser.add_argument("--cache", type=Path, default=default_cache(), help="for recordings")
    parser.add_argument("--output", type=Path, help="docs for the full plan, else build/benchmarks")
    parser.add_argument(
        "--capture", type=Path, help="a capture of yours (bag, 7-Scenes or TUM folder) as well"
    )
    return parser.parse_args(arguments)


def default_cache() -> Path:
    """The folder for rendered recordings, outside the repository."""
    home = os.environ.get("XDG_CACHE_HOME")
    return (Path(home) if home else Path.home() / ".cache") / "reflest" / "benchmarks"


if __name__ == "__main__":
    sys.exit(main())
