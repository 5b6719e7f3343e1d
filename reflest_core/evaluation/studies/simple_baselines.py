# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What an estimate must beat: guessing the mean, and a Lambertian surface from F and B."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.surface.observed_surface import ObservedSurface


def guess_mean(statistics: ParameterStatistics) -> NDArray[np.float64]:
    """(5,) the training set's mean Ward parameters, whatever is seen."""
    return statistics.mean.copy()


def lambertian(surface: ObservedSurface, statistics: ParameterStatistics) -> NDArray[np.float64]:
    """(5,) Ward parameters of a matt surface in uniform light: Eq. 7 with ``rho_s`` = 0.

    ``rho_d`` is the least-squares ratio of F to B over the views, in linear light, at most 1.
    ``alpha`` cannot be told and is the training mean.
    """
    foreground = srgb.decode(surface.view_foreground.astype(np.float64) / 255)
    background = srgb.decode(surface.view_background.astype(np.float64) / 255)
    known = ~(np.isnan(foreground) | np.isnan(background)).any(axis=1)
    f, b = foreground[known], background[known]
    ratio = (f * b).sum(axis=0) / np.maximum((b * b).sum(axis=0), 1e-9)
    return np.array([*np.clip(ratio, 0.0, 1.0), 0.0, statistics.mean[4]])
