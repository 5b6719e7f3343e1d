# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Linear radiance from ``.hdr`` and ``.exr`` images."""

from __future__ import annotations

import re
import stat
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

MOST_PIXELS = 2**26
"""Of an image: 16384 x 4096, which takes less than a gigabyte."""

MOST_BYTES = 2**30 + 2**20
"""Of a file: four uncompressed float channels of so many pixels, and a header."""

MOST_VALUES = 2**28
"""Of an ``.exr`` file, whose channels are all decoded: four of so many pixels, or more of fewer."""

LARGEST_RADIANCE = 1e12
"""In whatever unit a file has; sums over all directions of more would not be finite."""

HEADER_BYTES = 4096
"""The beginning of an ``.hdr`` file, where its size stands."""


@dataclass(frozen=True)
class RadianceImage:
    """An image of light.

    Attributes:
        radiance: (H, W, 3) float32, linear.
        coverage: (H, W) float32, alpha: the share of a pixel that is known; None without alpha.
        software: The program that wrote it, "" where the file does not say.
    """

    radiance: NDArray[np.float32]
    coverage: NDArray[np.float32] | None = None
    software: str = ""


def read_radiance(path: Path) -> RadianceImage:
    """Read an image; ``.exr`` by its suffix, anything else as Radiance ``.hdr``.

    Args:
        path: The file.

    Returns:
        The image, in whatever unit the file has.

    Raises:
        OSError: The file cannot be opened.
        ValueError: It cannot be decoded or is too large; a clause that says why.
    """
    _check_file(path)
    return _read_exr(path) if path.suffix.lower() == ".exr" else _read_hdr(path)


def _read_exr(path: Path) -> RadianceImage:
    import OpenEXR

    try:
        with OpenEXR.File(str(path), header_only=True) as file:
            first, last = (np.asarray(corner) for corner in file.header()["dataWindow"])
            count = sum(len(part.header["channels"]) for part in file.parts)
    except (RuntimeError, TypeError, KeyError, ValueError) as error:
        raise ValueError("it is damaged, or no OpenEXR image") from error
    width, height = (int(size) for size in last - first + 1)
    _check_size(width, height)
    if count * width * height > MOST_VALUES:
        raise ValueError(
            f"it has {count} channels of {width} x {height} pixels: keep R, G, B and A, or make it "
            "smaller"
        )
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            channels = {name: channel.pixels for name, channel in file.channels().items()}
    except (RuntimeError, TypeError, KeyError, ValueError) as error:
        raise ValueError("it is a damaged OpenEXR image") from error
    missing = [name for name in "RGB" if name not in channels]
    if missing:
        raise ValueError(f"its channels are {', '.join(sorted(channels))}, but R, G and B are read")
    colours = np.stack([np.asarray(channels[name], np.float32) for name in "RGB"], axis=-1)
    alpha = channels.get("A")
    return RadianceImage(colours, None if alpha is None else np.asarray(alpha, np.float32))


def _read_hdr(path: Path) -> RadianceImage:
    import cv2

    with path.open("rb") as file:
        header = file.read(HEADER_BYTES)
    size = re.search(rb"\n[-+][XY] (\d+) [-+][XY] (\d+)\n", header)
    if size is None:
        raise ValueError("it is no Radiance .hdr image")
    _check_size(int(size[1]), int(size[2]))
    image = cv2.imread(str(path), cv2.IMREAD_ANYDEPTH | cv2.IMREAD_COLOR)
    if image is None:
        raise ValueError("it is damaged, or no Radiance .hdr image")
    software = re.search(rb"\nSOFTWARE=([^\n]*)\n", header[: size.start() + 1])
    name = software[1].decode("ascii", "replace") if software else ""
    return RadianceImage(np.asarray(image[..., ::-1], np.float32), software=name)


def _check_file(path: Path) -> None:
    """Refuse what is no regular file or too large, before any of it is read."""
    status = path.stat()
    if not (stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode)):
        raise ValueError("it is no regular file")
    with path.open("rb"):  # the system's own words where it cannot be
        pass
    if status.st_size > MOST_BYTES:
        raise ValueError(
            f"it has {status.st_size >> 20} MB, more than {MOST_BYTES >> 20}: make it smaller"
        )


def _check_size(width: int, height: int) -> None:
    if width * height > MOST_PIXELS:
        raise ValueError(
            f"it has {width} x {height} pixels, more than {MOST_PIXELS}: make it smaller"
        )
