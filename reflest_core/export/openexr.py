# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""OpenEXR: an environment in 32-bit floats, with what of it was seen as alpha.

Written by the file layout of OpenEXR's documentation: single part, scan lines, no compression.
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from reflest_core.environment.environment_map import EnvironmentMap

MAGIC, VERSION = 20000630, 2
FLOAT = 2
"""Of a channel: 32 bits a pixel."""
LAT_LONG = 0
"""Of the attribute ``envmap``."""


def openexr(environment: EnvironmentMap, note: str) -> bytes:
    """The file: R, G, B are linear radiance, A is the coverage; ``note`` goes into the header.

    The colours are whole everywhere, not premultiplied with A, so that light which was not seen
    shines as completed.
    """
    channels = {"A": environment.coverage}
    channels |= {name: environment.radiance[..., place] for place, name in enumerate("RGB")}
    height, width = environment.coverage.shape
    # A block is one line: all of its A, then B, G, R, for channels go by their names.
    lines = np.stack([channels[name] for name in sorted(channels)], axis=1).astype("<f4")
    head = _header(sorted(channels), width, height, note)
    size = lines[0].nbytes
    first = len(head) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(first + y * (8 + size) for y in range(height)))
    blocks = (struct.pack("<ii", y, size) + lines[y].tobytes() for y in range(height))
    return head + offsets + b"".join(blocks)


def _header(channels: list[str], width: int, height: int, note: str) -> bytes:
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    described = b"".join(
        name.encode() + b"\0" + struct.pack("<iBxxxii", FLOAT, 0, 1, 1) for name in channels
    )
    return (
        struct.pack("<ii", MAGIC, VERSION)
        + _attribute("channels", "chlist", described + b"\0")
        + _attribute("comments", "string", note.encode())
        + _attribute("compression", "compression", b"\0")
        + _attribute("dataWindow", "box2i", window)
        + _attribute("displayWindow", "box2i", window)
        + _attribute("envmap", "envmap", bytes([LAT_LONG]))
        + _attribute("lineOrder", "lineOrder", b"\0")
        + _attribute("pixelAspectRatio", "float", struct.pack("<f", 1.0))
        + _attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0.0, 0.0))
        + _attribute("screenWindowWidth", "float", struct.pack("<f", 1.0))
        + b"\0"
    )


def _attribute(name: str, kind: str, value: bytes) -> bytes:
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
