"""JPEG artefacts: a real codec for images, and what it does to lone pixels for sparse scenes."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.realism.settings import LOSSLESS, Realism

BEST_QUALITY = 95
LUMA_ERROR = (0.9, 0.022)
"""8-bit levels at quality 95, and more for each step of quality below."""
CHROMA_ERROR = (1.0, 0.03)


def draw_quality(realism: Realism, rng: np.random.Generator) -> int:
    """A scene's quality."""
    quality = int(rng.integers(min(realism.jpeg_quality, BEST_QUALITY), BEST_QUALITY + 1))
    return LOSSLESS if realism.jpeg_quality == LOSSLESS else quality


def compressed(image: NDArray[np.uint8], quality: int) -> NDArray[np.uint8]:
    """(H, W, 3) uint8 sRGB after a round trip through JPEG with 4:2:0 chroma."""
    if quality == LOSSLESS:
        return image
    _, data = cv2.imencode(".jpg", image[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])
    decoded = np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), np.uint8)
    return np.ascontiguousarray(decoded[..., ::-1])


def compression_error(count: int, quality: int, rng: np.random.Generator) -> NDArray[np.float32]:
    """8-bit RGB errors (count, 3) as :func:`compressed` makes them at pixels far from each other.

    Independent normal errors of Y, Cb and Cr whose stddev was measured on rendered images.
    """
    below = BEST_QUALITY - quality
    stddev = np.array(
        [base + slope * below for base, slope in (LUMA_ERROR, CHROMA_ERROR, CHROMA_ERROR)],
        np.float32,
    )
    y, cb, cr = (stddev * rng.standard_normal((count, 3), np.float32)).T
    return np.stack([y + 1.402 * cr, y - 0.344136 * cb - 0.714136 * cr, y + 1.772 * cb], axis=1)
