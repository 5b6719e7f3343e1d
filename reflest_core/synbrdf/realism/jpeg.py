# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""JPEG artefacts: a real codec for images, and what it does to lone pixels for sparse scenes."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.realism.settings import LOSSLESS, Realism

BEST_QUALITY = 95
MEASURED_QUALITIES = (60, 70, 80, 90, 95)
LUMA_ERROR = (4.8, 4.3, 3.5, 2.3, 1.4)
"""8-bit levels, stddev over objects' pixels (``reflest synbrdf measure jpeg``)."""
CHROMA_ERROR = (3.2, 3.0, 2.7, 2.4, 2.1)


def draw_quality(realism: Realism, rng: np.random.Generator) -> int:
    """A scene's quality.

    Args:
        realism: which faults, and how strong.
        rng: random numbers; the same state draws the same.
    """
    quality = int(rng.integers(min(realism.jpeg_quality, BEST_QUALITY), BEST_QUALITY + 1))
    return LOSSLESS if realism.jpeg_quality == LOSSLESS else quality


def compressed(image: NDArray[np.uint8], quality: int) -> NDArray[np.uint8]:
    """(H, W, 3) uint8 sRGB after a round trip through JPEG with 4:2:0 chroma.

    Args:
        image: (H, W, 3) pixels.
        quality: of JPEG, 1 to 100; 100 leaves the image as it is.
    """
    if quality == LOSSLESS:
        return image
    _, data = cv2.imencode(".jpg", image[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])
    decoded = np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), np.uint8)
    return np.ascontiguousarray(decoded[..., ::-1])


def compression_error(count: int, quality: int, rng: np.random.Generator) -> NDArray[np.float32]:
    """8-bit RGB errors (count, 3) as :func:`compressed` makes them at pixels far from each other.

    Independent normal errors of Y, Cb and Cr whose stddev was measured on rendered images.

    Args:
        count: pixels to draw.
        quality: of JPEG, 1 to 95.
        rng: random numbers; the same state draws the same.
    """
    luma, chroma = (
        np.interp(quality, MEASURED_QUALITIES, error) for error in (LUMA_ERROR, CHROMA_ERROR)
    )
    stddev = np.array([luma, chroma, chroma], np.float32)
    y, cb, cr = (stddev * rng.standard_normal((count, 3), np.float32)).T
    return np.stack([y + 1.402 * cr, y - 0.344136 * cb - 0.714136 * cr, y + 1.772 * cb], axis=1)
