# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a BRDF model must offer: it names its parameters, and is evaluated and sampled.

A material is a vector of the model's parameters.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import sampling

Array = Any


@dataclass(frozen=True)
class BrdfParameter:
    """One value of a material's vector.

    Attributes:
        name: As it is printed.
        lowest: Smallest physical value.
        highest: Largest physical value.
    """

    name: str
    lowest: float
    highest: float


class BrdfModel(Protocol):
    """An isotropic BRDF in linear sRGB; directions are unit vectors with +z on the normal."""

    @property
    def name(self) -> str:
        """What files and messages call the model."""

    @property
    def parameters(self) -> tuple[BrdfParameter, ...]:
        """The P values of a material's vector, in order."""

    def evaluate(self, material: Array, omega_i: Array, omega_o: Array) -> Array:
        """Evaluate the BRDF.

        Args:
            material: (..., P) vectors.
            omega_i: (..., 3) directions of incidence.
            omega_o: (..., 3) directions to the camera.

        Returns:
            (..., 3) in 1/sr; 0 where a direction lies below the surface.
        """

    def sample(self, material: Array, omega_o: Array, u: Array) -> tuple[Array, Array]:
        """Draw directions of incidence from the specular lobe.

        Args:
            material: (P,) a vector.
            omega_o: (..., 3) directions to the camera.
            u: (..., 2) uniform in [0, 1).

        Returns:
            (..., 3) directions and (...) their weights ``f_s cos theta_i / density``.
        """

    def albedo(
        self, material: NDArray[np.float64], cos_theta_o: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Integrate the BRDF over light that comes from everywhere above.

        Args:
            material: (P,) a vector.
            cos_theta_o: (K,) cosines of the angle between normal and camera, in (0, 1].

        Returns:
            (K, 3) the reflected share.
        """


def lobe_albedo(
    model: BrdfModel,
    material: NDArray[np.float64],
    cos_theta_o: NDArray[np.float64],
    strata: int = sampling.STRATA,
) -> NDArray[np.float64]:
    """Integrate a model's specular lobe by its own samples.

    Args:
        model: Its ``sample`` is used.
        material: (P,) a vector.
        cos_theta_o: (K,) cosines of the angle between normal and camera, in (0, 1].
        strata: Samples along each edge of the unit square.

    Returns:
        (K,) the share of light that the lobe sends to the camera, where it comes from everywhere.
    """
    _, weights = model.sample(
        material, sampling.view_directions(cos_theta_o), sampling.strata(strata)[None]
    )
    mean: NDArray[np.float64] = weights.mean(axis=1)
    return mean
