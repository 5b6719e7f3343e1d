# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Shot and read noise of an image sensor, in linear light before it is quantised."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reflest_core.synbrdf.realism.settings import Realism


@dataclass(frozen=True)
class SensorNoise:
    """Variance ``shot^2 x + read^2`` of a signal ``x`` in units of full scale.

    The usual Poisson-Gaussian model with the Poisson part as a Gaussian of the same variance
    (Foi et al., "Practical Poissonian-Gaussian noise modeling", IEEE TIP 2008): ``1 / shot^2`` is
    the number of electrons at full scale.
    """

    shot: float
    read: float

    @classmethod
    def drawn(cls, realism: Realism, rng: np.random.Generator) -> SensorNoise:
        """A scene's noise: one gain (ISO) raises both parts.

        Args:
            realism: which faults, and how strong.
            rng: random numbers; the same state draws the same.
        """
        gain = rng.uniform()
        return cls(realism.shot_noise * gain, realism.read_noise * gain)

    def applied(self, signal: NDArray[np.float32], rng: np.random.Generator) -> NDArray[np.float32]:
        """The signal with noise, same shape; it may be below 0, as before a black level is cut.

        Args:
            signal: linear radiance in units of white.
            rng: random numbers; the same state draws the same.
        """
        light = np.maximum(signal, np.float32(0.0))
        stddev = np.sqrt(np.float32(self.shot**2) * light + np.float32(self.read**2))
        noise = rng.standard_normal(signal.shape, dtype=np.float32)
        return np.asarray(signal + stddev * noise, np.float32)
