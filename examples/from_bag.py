# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Estimate the material of a recording: an MCAP file, a rosbag2 folder or an image folder.

python examples/from_bag.py [CAPTURE [FOLDER]]

``material.gltf`` and ``light.hdr`` are written into FOLDER, by default the current one.
"""

import sys
from pathlib import Path

from reflest_core import ReflestError, Scanner, open_capture, sphere

SHIPPED = Path(__file__).parents[1] / "captures" / "glossy-red"


def main(path: Path, folder: Path) -> None:
    """Scan a capture, print what it is made of, and write the material and the light."""
    # The shipped capture shows one object about the origin. Leave out the region for a whole scene.
    scanner = Scanner(region=sphere(centre=(0.0, 0.0, 0.0), radius=0.3))
    for frame in open_capture(path):
        try:
            scanner.add_frame(frame)
        except ReflestError as refused:
            print(f"skipped a frame: {refused}")
    estimate = scanner.estimate()
    red, green, blue = estimate.rho_d
    print(f"rho_d {red:.3f} {green:.3f} {blue:.3f}  (linear sRGB)")
    print(f"rho_s {estimate.rho_s:.3f} +- {estimate.rho_s_stddev:.3f}")
    print(f"alpha {estimate.alpha:.3f} +- {estimate.alpha_stddev:.3f}")
    print(f"{estimate.status.name} {estimate.status_text}")
    for name in ("material.gltf", "light.hdr"):
        scanner.export(folder / name)
        print(f"wrote {folder / name}")


if __name__ == "__main__":
    main(
        Path(sys.argv[1]) if len(sys.argv) > 1 else SHIPPED,
        Path(sys.argv[2]) if len(sys.argv) > 2 else Path(),
    )
