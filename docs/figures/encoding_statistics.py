# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Statistics of images as they are, in linear light and gamma-encoded twice, for docs/captures.md.

python docs/figures/encoding_statistics.py CAPTURE...
"""

import argparse
import itertools
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reflest_core.capture.open_capture import open_capture

STRIDE, IMAGES = 8, 4
"""Every eighth image, four of each capture."""
DARK = 16
"""Level below which a pixel counts as dark."""
NAMES = ("median level", "5 % darkest", "share of dark pixels", "detail, dark over bright", "gaps")
LEVELS = np.arange(256) / 255.0
DECODED = np.where(LEVELS <= 0.04045, LEVELS / 12.92, ((LEVELS + 0.055) / 1.055) ** 2.4)
ENCODED = np.where(LEVELS <= 0.0031308, 12.92 * LEVELS, 1.055 * LEVELS ** (1 / 2.4) - 0.055)
ENCODINGS = {
    "sRGB": np.arange(256),
    "linear light": np.rint(255.0 * DECODED).astype(np.intp),
    "encoded twice": np.rint(255.0 * ENCODED).astype(np.intp),
}
Image = NDArray[np.intp]


def statistics_of(image: Image) -> NDArray[np.float64]:
    """Measure what could tell an encoding; (5,) in the order of :data:`NAMES`."""
    grey = image.mean(axis=2)
    detail = np.abs(np.diff(grey, axis=1))
    level = (grey[:, 1:] + grey[:, :-1]) / 2.0
    dark, bright = np.quantile(level, (0.2, 0.8))
    ratio = (np.median(detail[level <= dark]) + 0.07) / (np.median(detail[level >= bright]) + 0.07)
    return np.array(
        [
            np.median(grey),
            np.quantile(grey, 0.05),
            (grey < DARK).mean(),
            ratio,
            np.mean([_gaps(image[..., channel]) for channel in range(3)]),
        ]
    )


def _gaps(channel: Image) -> float:
    """The share of levels between the least and the greatest that no pixel has."""
    counts = np.bincount(channel.ravel(), minlength=256)
    used = np.flatnonzero(counts)
    return float((counts[used[0] : used[-1] + 1] == 0).mean())


def main() -> None:
    """Print the range of each statistic over the captures, for each encoding."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("captures", type=Path, nargs="+", help="captures in sRGB")
    found: dict[str, list[NDArray[np.float64]]] = {name: [] for name in ENCODINGS}
    for path in parser.parse_args().captures:
        frames = itertools.islice(open_capture(path), 0, STRIDE * IMAGES, STRIDE)
        images = [frame.rgb for frame in frames]
        for name, table in ENCODINGS.items():
            of_images = [statistics_of(table[image]) for image in images]
            found[name].append(np.mean(of_images, axis=0))
    print("| | " + " | ".join(ENCODINGS) + " |\n|---|" + "---|" * len(ENCODINGS))
    for index, name in enumerate(NAMES):
        columns = [np.array(rows)[:, index] for rows in found.values()]
        print(
            f"| {name} | " + " | ".join(f"{c.min():.2g} to {c.max():.2g}" for c in columns) + " |"
        )


if __name__ == "__main__":
    main()
