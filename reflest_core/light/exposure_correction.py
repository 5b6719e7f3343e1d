# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Observed colours as one exposure would have shown them, where the camera changed its own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.jit import compiled

LINEAR = np.asarray(srgb.decode(np.arange(256) / 255.0))


def at_one_exposure(
    colours: NDArray[np.uint8], gains: NDArray[np.float32], views: NDArray[np.uint16]
) -> NDArray[np.uint8]:
    """Bring colours of several exposures to a common one.

    A channel at 255 stays there: it is a lower bound, whatever the exposure. What passes white at
    the common exposure becomes 255. Where every gain is 1 the colours come back as they are.

    Args:
        colours: (O, 3) 8-bit sRGB.
        gains: (W,) factors on each view's linear light.
        views: (O,) the view of each colour.

    Returns:
        (O, 3) 8-bit sRGB.
    """
    different, which = np.unique(gains, return_inverse=True)
    if not np.any(different != 1.0):
        return colours
    encoded = srgb.encode(LINEAR * different[:, None].astype(np.float64))
    table = np.asarray(np.rint(encoded * 255.0), np.uint8)
    table[:, 255] = 255
    return _looked_up(table, which, colours, views)


def means_at_one_exposure(
    means: NDArray[np.float32], gains: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Bring mean colours of views, F or B, to a common exposure.

    Exact for a view that shows one colour, an approximation for others.

    Args:
        means: (W, 3) mean 8-bit colours; NaN stays NaN.
        gains: (W,) factors on each view's linear light.

    Returns:
        (W, 3) mean 8-bit colours.
    """
    is_other = gains != 1.0
    corrected = means.copy()
    if not is_other.any():
        return corrected
    linear = srgb.decode(means[is_other] / 255.0) * gains[is_other, None]
    corrected[is_other] = srgb.encode(linear) * 255.0
    return corrected


@compiled
def _looked_up(
    table: NDArray[np.uint8],
    rows: NDArray[np.int64],
    colours: NDArray[np.uint8],
    views: NDArray[np.uint16],
) -> NDArray[np.uint8]:
    """Each of ``colours`` (O, 3) in the row of the ``table`` (G, 256) that its view's ``rows`` say.

    Indexing with arrays takes ten times as long, and every keyframe waits for it.
    """
    found = np.empty_like(colours)
    for n in range(len(colours)):
        row = rows[views[n]]
        for channel in range(3):
            found[n, channel] = table[row, colours[n, channel]]
    return found
