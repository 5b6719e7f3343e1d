# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How unlike two pictures look: FLIP, PSNR and SSIM."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.evaluation.contenders import EvaluationError

PIXELS_PER_DEGREE = 30.0
"""A picture of 64 pixels seen as a swatch of two degrees: a coin at arm's length."""


@dataclass(frozen=True)
class ImageDistance:
    """``flip``: mean of Andersson et al. 2020, 0 to 1. ``psnr``: dB. ``ssim``: up to 1."""

    flip: float
    psnr: float
    ssim: float


def image_distance(reference: NDArray[np.float64], other: NDArray[np.float64]) -> ImageDistance:
    """Of two sRGB pictures (H, W, 3) in [0, 1]."""
    try:
        import flip_evaluator
        from skimage.metrics import structural_similarity
    except ImportError as error:
        raise EvaluationError(
            f"image metrics need {error.name}: pip install 'reflest-ros[training]'"
        ) from error
    pair = np.asarray(reference, np.float32), np.asarray(other, np.float32)
    _, flip, _ = flip_evaluator.evaluate(
        *pair, "LDR", applyMagma=False, parameters={"ppd": PIXELS_PER_DEGREE}
    )
    squared = float(np.mean((reference - other) ** 2))
    # Equal pictures have no finite PSNR; 8 bits could not tell more than this.
    psnr = -10 * np.log10(max(squared, (0.5 / 255) ** 2))
    ssim = structural_similarity(
        *pair, channel_axis=2, data_range=1.0, gaussian_weights=True, use_sample_covariance=False
    )
    return ImageDistance(float(flip), float(psnr), float(ssim))
