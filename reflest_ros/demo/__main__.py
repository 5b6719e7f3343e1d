# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""``python -m reflest_ros.demo [--capture BAG] [--output FOLDER]``."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from reflest_core.errors import ReflestError
from reflest_core.estimation.estimate import EstimateStatus
from reflest_ros.demo.comparison import compare, table
from reflest_ros.demo.playback import estimate_over_dds
from reflest_ros.demo.shipped_capture import find_capture


def main(arguments: list[str] | None = None) -> int:
    """Run the demo; 0 if a picture was written, 2 with one sentence otherwise.

    Args:
        arguments: the words of the command; None takes those of the process.
    """
    parser = argparse.ArgumentParser(prog="reflest demo", description=__doc__)
    parser.add_argument("--capture", type=Path, help="bag folder with truth.json")
    parser.add_argument("--output", type=Path, default=Path("demo-output"))
    options = parser.parse_args(arguments)
    try:
        return _demo(options)
    except ReflestError as error:
        print(f"reflest: error: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def _demo(options: argparse.Namespace) -> int:
    capture = find_capture(options.capture)
    print(f"playing {capture.bag} over DDS to `ros2 run reflest_ros estimator`", flush=True)
    estimate = estimate_over_dds(capture.bag)
    compared = compare(estimate, capture.truth)
    print(f"\nthe whole scan, {estimate.model_id}, Ward variant {estimate.ward_variant}:\n")
    print(f"{table(compared)}\n")
    if estimate.status is not EstimateStatus.OK:
        print(f"{estimate.status.name}: {estimate.status_text}\n")
    sys.stdout.flush()

    # Matplotlib takes a while to import: the comparison is on the screen meanwhile.
    from reflest_ros.demo.picture import draw

    picture = options.output / "reflest-demo.png"
    draw(picture, capture.close_up(), capture.true_ward, estimate, compared, capture.name)
    print(f"wrote {picture}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
