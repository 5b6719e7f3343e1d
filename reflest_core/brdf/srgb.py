# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The sRGB transfer curve (IEC 61966-2-1): linear light and encoded values, both in [0, 1]."""

from __future__ import annotations

from typing import Any

import numpy as np
from array_api_compat import array_namespace
from numpy.typing import NDArray

Array = Any


def encode(linear: Array) -> Array:
    """Convert linear light to sRGB values.

    Args:
        linear: Numpy or torch, any shape; clipped to [0, 1].

    Returns:
        sRGB values in [0, 1].
    """
    xp = array_namespace(linear)
    clipped = xp.clip(linear, 0, 1)
    curve = 1.055 * xp.clip(clipped, 0.0031308, 1) ** (1 / 2.4) - 0.055
    return xp.where(clipped <= 0.0031308, 12.92 * clipped, curve)


def decode(encoded: Array) -> Array:
    """Convert sRGB values to linear light.

    Args:
        encoded: Numpy or torch, any shape; clipped to [0, 1].

    Returns:
        Linear light in [0, 1].
    """
    xp = array_namespace(encoded)
    clipped = xp.clip(encoded, 0, 1)
    curve = ((xp.clip(clipped, 0.04045, 1) + 0.055) / 1.055) ** 2.4
    return xp.where(clipped <= 0.04045, clipped / 12.92, curve)


LINEAR: NDArray[np.float32] = np.asarray(decode(np.arange(256) / 255.0), np.float32)
"""(256,) linear light of the 8-bit values."""
