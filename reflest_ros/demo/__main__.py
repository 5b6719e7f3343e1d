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
from reflest_ros.demo.matched_materials import match_materials, material_table
from reflest_ros.demo.playback import Played, play_over_dds
from reflest_ros.demo.shipped_capture import ShippedCapture, find_capture

PICTURE = "reflest-demo.png"


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
    print(
        f"starting `ros2 run reflest_ros estimator`, then playing {capture.bag} to it over DDS; "
        "the first start compiles kernels for a minute or two",
        flush=True,
    )
    played = play_over_dds(capture.bag, options.output)
    if capture.has_many_materials:
        _show_table(capture, played, options.output)
    else:
        _show_object(capture, played, options.output)
    return 0


def _show_object(capture: ShippedCapture, played: Played, output: Path) -> None:
    """The comparison of one material: a table on the terminal, and a picture."""
    estimate = played.estimate
    compared = compare(estimate, capture.truth)
    print(f"\nthe whole scan, {estimate.model_id}, Ward variant {estimate.ward_variant}:\n")
    print(f"{table(compared)}\n")
    if estimate.status is not EstimateStatus.OK:
        print(f"{estimate.status.name}: {estimate.status_text}\n")
    sys.stdout.flush()

    # Matplotlib takes a while to import: the comparison is on the screen meanwhile.
    from reflest_ros.demo.picture import draw

    picture = output / PICTURE
    draw(picture, capture.close_up(), capture.true_ward, estimate, compared, capture.name)
    print(f"wrote {picture}")


def _show_table(capture: ShippedCapture, played: Played, output: Path) -> None:
    """All materials: a table on the terminal, a picture, the asset and the report."""
    matched = match_materials(capture.truth, capture.true_points(), played.voxels, played.materials)
    print(f"\nthe whole scan, {played.estimate.model_id}, {len(played.materials)} materials:\n")
    print(f"{material_table(matched)}\n", flush=True)

    from reflest_ros.demo.model import Model
    from reflest_ros.demo.table_picture import draw_table

    print("making the model: mesh, textures, pictures", flush=True)
    frame, model = capture.middle_frame(), Model(played.scan)
    draw_table(output / PICTURE, frame, model, matched)
    print(f"wrote {output / PICTURE}")
    model.export(output / f"{capture.name}.glb")
    print(f"wrote {output / capture.name}.glb: drop it into any glTF viewer")
    model.write_report(output / f"{capture.name}.html", frame, capture.name)
    print(f"wrote {output / capture.name}.html: open it in a browser")
    print(f"wrote {played.scan}: `reflest view {played.scan}` shows it")


if __name__ == "__main__":
    sys.exit(main())
