# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""RVL, the lossless depth codec of Wilson (ISS 2017), as compressedDepth sends it.

A stream of 4-bit groups, the highest bits of little-endian 32-bit words first; a number is sent in
groups of three bits, lowest first, whose fourth bit says that another follows. Pixels come in runs:
how many are 0, how many are not, then each of the latter as its zigzag-coded difference to the one
before.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.jit import compiled

LONGEST_NUMBER = 11  # groups in a 32-bit number


def decode_rvl(data: bytes, height: int, width: int) -> NDArray[np.uint16] | None:
    """Return the (height, width) uint16 image in ``data``, or None where it ends early or lies.

    Args:
        data: the bytes after the header.
        height: pixels.
        width: pixels.
    """
    words = np.frombuffer(data[: len(data) // 4 * 4], dtype="<u4").astype(np.uint32)
    pixels = np.zeros(height * width, np.uint16)
    return pixels.reshape(height, width) if _unpack(words, pixels) else None


@compiled
def _unpack(words: NDArray[np.uint32], pixels: NDArray[np.uint16]) -> bool:
    position, done, previous = 0, 0, 0
    while done < len(pixels):
        zeros, position = _number(words, position)
        if zeros < 0 or zeros > len(pixels) - done:
            return False
        done += zeros
        others, position = _number(words, position)
        if others < 0 or others > len(pixels) - done or zeros + others == 0:
            return False
        for index in range(done, done + others):
            zigzag, position = _number(words, position)
            if zigzag < 0:
                return False
            previous = (previous + ((zigzag >> 1) ^ -(zigzag & 1))) & 0xFFFF
            pixels[index] = previous
        done += others
    return True


@compiled
def _number(words: NDArray[np.uint32], position: int) -> tuple[int, int]:
    """The number that starts at a group, and the next group; -1 where the stream ends."""
    number = np.int64(0)
    for place in range(LONGEST_NUMBER):
        word = position // 8
        if word >= len(words):
            return -1, position
        group = (np.int64(words[word]) >> (28 - 4 * (position % 8))) & 15
        position += 1
        number |= (group & 7) << (3 * place)
        if group < 8:
            return int(number), position
    return -1, position
