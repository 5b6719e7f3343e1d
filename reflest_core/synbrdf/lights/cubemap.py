# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Environments in KTX cube maps, as Filament's tools write them and Open3D's wheels carry them.

KTX 1 (Khronos), six faces of ``R11F_G11F_B10F``: floats of 5 exponent bits without a sign. Faces
are +x, -x, +y, -y, +z, -z of OpenGL's left-handed cube with y up.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

IDENTIFIER = b"\xabKTX 11\xbb\r\n\x1a\n"
R11F_G11F_B10F = 0x8C3A
LITTLE_ENDIAN = 0x04030201
_ACROSS_AND_DOWN: tuple[Callable[..., tuple[Any, Any]], ...] = (
    lambda x, y, z: (-z, -y),
    lambda x, y, z: (z, -y),
    lambda x, y, z: (x, z),
    lambda x, y, z: (x, -z),
    lambda x, y, z: (x, -y),
    lambda x, y, z: (-x, -y),
)
"""Coordinates on each face, in units of the direction's greatest coordinate (OpenGL 4.6, 8.13)."""


def read_cubemap(path: Path) -> NDArray[np.float32]:
    """Faces (6, N, N, 3) of linear radiance; ``ValueError`` says what cannot be read.

    Args:
        path: the file.
    """
    data = path.read_bytes()
    if data[:12] != IDENTIFIER or len(data) < 68:
        raise ValueError("it is not a KTX 1 file")
    endianness, _, _, _, internal, _, width, height, _, _, faces, _, skipped = struct.unpack(
        "<13I", data[12:64]
    )
    if endianness != LITTLE_ENDIAN or internal != R11F_G11F_B10F or faces != 6 or width != height:
        raise ValueError("only square cube maps of R11F_G11F_B10F, little-endian, are read")
    start = 64 + skipped + 4  # the first level's size stands before it
    packed = np.frombuffer(data[start : start + 24 * width * width], "<u4")
    if len(packed) != 6 * width * width:
        raise ValueError("it ends before its last face")
    packed = packed.reshape(6, width, width)
    channels = [(packed & 0x7FF, 6), ((packed >> 11) & 0x7FF, 6), (packed >> 22, 5)]
    return np.stack([_small_float(bits, mantissa) for bits, mantissa in channels], axis=-1)


def look_up(faces: NDArray[np.float32], directions: NDArray[np.float64]) -> NDArray[np.float32]:
    """Look up the texel in each direction.

    Args:
        faces: (6, N, N, 3) linear radiance.
        directions: (..., 3), world frame, z up.

    Returns:
        (..., 3) radiance.
    """
    # The cube's y is up, and its z is the world's -y.
    cube = np.stack([directions[..., 0], directions[..., 2], -directions[..., 1]])
    axis = np.abs(cube).argmax(axis=0)
    size = faces.shape[1]
    radiance = np.zeros((*directions.shape[:-1], 3), np.float32)
    for face, coordinates in enumerate(_ACROSS_AND_DOWN):
        on_face = (axis == face // 2) & ((cube[face // 2] > 0) == (face % 2 == 0))
        here = cube[:, on_face]
        across, down = coordinates(*here / np.abs(here[face // 2]))
        column, row = (
            np.clip(((c + 1.0) / 2.0 * size).astype(np.int64), 0, size - 1) for c in (across, down)
        )
        radiance[on_face] = faces[face, row, column]
    return radiance


def _small_float(bits: NDArray[Any], mantissa_bits: int) -> NDArray[np.float32]:
    """Unsigned floats with 5 exponent bits, biased by 15; infinities become the largest number."""
    exponent = np.minimum(bits >> mantissa_bits, 30).astype(np.int32)
    mantissa = (bits & ((1 << mantissa_bits) - 1)) / 2.0**mantissa_bits
    normal = np.ldexp(1.0 + mantissa, exponent - 15)
    return np.where(exponent == 0, np.ldexp(mantissa, -14), normal).astype(np.float32)
