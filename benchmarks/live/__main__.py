# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``python -m benchmarks.live [--seconds 60] [--viewer]``: the live benchmark alone."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks.__main__ import default_cache
from benchmarks.plan import FULL
from benchmarks.report.run_sections import live_section, viewer_section
from benchmarks.run import run_live
from benchmarks.scene.recording import Recording, recorded
from reflest_core.cli.output_files import write_json
from reflest_core.errors import ReflestError
from reflest_core.whole_file import check_writable


def main(arguments: list[str] | None = None) -> int:
    """Play the bag and print the table.

    Args:
        arguments: The command line; None for the process's own.

    Returns:
        0, or 2 after one sentence of error.
    """
    parser = argparse.ArgumentParser(prog="python -m benchmarks.live", description=__doc__)
    parser.add_argument("--seconds", type=float, default=FULL.live_seconds)
    parser.add_argument("--rate", type=float, default=FULL.rate, help="frames a second")
    parser.add_argument("--cache", type=Path, default=default_cache(), help="for recordings")
    parser.add_argument(
        "--viewer", action="store_true", help="play it again with the viewer: what that costs"
    )
    parser.add_argument("--json", type=Path, metavar="OUT", help="write the figures as JSON")
    options = parser.parse_args(arguments)
    recording = Recording(*FULL.resolution, round(options.seconds * options.rate), options.rate)
    try:
        if options.json is not None:
            check_writable(options.json)
        bag = str(recorded(recording, options.cache))
        live = run_live(recording, bag)
        if options.viewer:
            live["with_viewer"] = run_live(recording, bag, has_viewer=True)
        if options.json is not None:
            write_json(options.json, live)
    except ReflestError as error:
        print(f"reflest: error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    print(live_section({"live": live}))
    if options.viewer:
        print(viewer_section(live))
    return 0


if __name__ == "__main__":
    sys.exit(main())
