# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Distances between two pictures: FLIP, PSNR and SSIM."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import ThreadpoolController

from reflest_core.evaluation.networks import EvaluationError

PIXELS_PER_DEGREE = 30.0
"""A picture of 64 pixels seen as a swatch of two degrees: a coin at arm's length."""


@dataclass(frozen=True)
class ImageDistance:
    """Distances of a picture from its reference.

    Attributes:
        flip: Mean FLIP (Andersson et al. 2020), 0 for equal pictures, at most 1.
        psnr: Peak signal to noise ratio, decibels.
        ssim: Structural similarity, 1 for equal pictures.
    """

    flip: float
    psnr: float
    ssim: float


@dataclass(frozen=True)
class _Metrics:
    flip: Callable[..., Any]
    structural_similarity: Callable[..., Any]
    libraries: ThreadpoolController


@cache
def _metrics() -> _Metrics:
    try:
        import flip_evaluator
        from skimage.metrics import structural_similarity
    except ImportError as error:
        raise EvaluationError(
            f"image metrics need {error.name}: pip install 'reflest-ros[training]'"
        ) from error
    return _Metrics(flip_evaluator.evaluate, structural_similarity, ThreadpoolController())


def image_distance(reference: NDArray[np.float64], other: NDArray[np.float64]) -> ImageDistance:
    """Compare two pictures.

    Args:
        reference: (H, W, 3) sRGB in [0, 1].
        other: The same shape.

    Raises:
        EvaluationError: a package of the extra ``training`` is missing.
    """
    metrics = _metrics()
    pair = np.asarray(reference, np.float32), np.asarray(other, np.float32)
    # A thread for every core takes twenty times as long as one for so small a picture.
    with metrics.libraries.limit(limits=1, user_api="openmp"):
        _, flip, _ = metrics.flip(
            *pair, "LDR", applyMagma=False, parameters={"ppd": PIXELS_PER_DEGREE}
        )
    squared = float(np.mean((reference - other) ** 2))
    # Equal pictures have no finite PSNR; 8 bits resolve no more than this.
    psnr = -10 * np.log10(max(squared, (0.5 / 255) ** 2))
    ssim = metrics.structural_similarity(
        *pair, channel_axis=2, data_range=1.0, gaussian_weights=True, use_sample_covariance=False
    )
    return ImageDistance(float(flip), float(psnr), float(ssim))
