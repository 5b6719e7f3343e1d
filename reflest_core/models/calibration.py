# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What turns the deviations that a network states into those that its errors have."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Calibration:
    """A power law for each Ward parameter: ``factors`` (5,) times the deviation to ``powers`` (5,).

    Powers above 1 say that the network is too modest where it is sure and too bold where it is not.
    ``correlation``: (5, 5) of errors over calibrated deviations.
    """

    factors: NDArray[np.float64] = field(default_factory=lambda: np.ones(5))
    powers: NDArray[np.float64] = field(default_factory=lambda: np.ones(5))
    correlation: NDArray[np.float64] = field(default_factory=lambda: np.eye(5))

    def calibrated(self, deviations: NDArray[np.float64]) -> NDArray[np.float64]:
        """(..., 5) of what a network stated, both of z-scored parameters."""
        made_true: NDArray[np.float64] = self.factors * deviations**self.powers
        return made_true
