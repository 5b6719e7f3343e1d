# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The BRDF models by name; each keeps the protocol of :mod:`reflest_core.brdf.protocol`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reflest_core.brdf import sampling, ward
from reflest_core.brdf.ggx import ggx_density, ggx_lobe, sample_ggx
from reflest_core.brdf.parameters import (
    ALPHA,
    PARAMETERS,
    RHO_D,
    RHO_S,
    SMALLEST_ALPHA,
    WardVariant,
)
from reflest_core.brdf.protocol import BrdfModel, BrdfParameter, lobe_albedo

Array = Any
BASE, F0, WIDTH = slice(0, 3), 3, 4
"""Where a vector of :class:`Ggx` holds its parameters."""


@dataclass(frozen=True)
class Ward:
    """Ward's model in one of its normalisations; vectors of ``rho_d`` (3), ``rho_s``, ``alpha``.

    Attributes:
        variant: The specular normalisation.
    """

    variant: WardVariant = WardVariant.WARD_1992

    @property
    def name(self) -> str:
        """The variant's name."""
        return self.variant.value

    @property
    def parameters(self) -> tuple[BrdfParameter, ...]:
        """``rho_d`` (3), ``rho_s``, ``alpha``."""
        lowest = (0.0, 0.0, 0.0, 0.0, SMALLEST_ALPHA)
        return tuple(map(BrdfParameter, PARAMETERS, lowest, (1.0, 1.0, 1.0, 1.0, 1.0)))

    def evaluate(self, material: Array, omega_i: Array, omega_o: Array) -> Array:
        """Evaluate the BRDF; numpy or torch.

        Args:
            material: (..., 5) vectors.
            omega_i: (..., 3) directions of incidence.
            omega_o: (..., 3) directions to the camera.

        Returns:
            (..., 3) in 1/sr; 0 where a direction lies below the surface.
        """
        rho_d, rho_s, alpha = material[..., RHO_D], material[..., RHO_S], material[..., ALPHA]
        return ward.evaluate(rho_d, rho_s, alpha, omega_i, omega_o, self.variant)

    def sample(self, material: Array, omega_o: Array, u: Array) -> tuple[Array, Array]:
        """Draw directions of incidence from the specular lobe; numpy or torch.

        Args:
            material: (5,) a vector.
            omega_o: (..., 3) directions to the camera.
            u: (..., 2) uniform in [0, 1).

        Returns:
            (..., 3) directions and (...) their weights ``f_s cos theta_i / density``.
        """
        omega_i = sampling.sample_specular(material[ALPHA], omega_o, u)
        return omega_i, sampling.specular_weight(material[RHO_S], omega_i, omega_o, self.variant)

    def albedo(
        self, material: NDArray[np.float64], cos_theta_o: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Integrate the BRDF over light that comes from everywhere above.

        Args:
            material: (5,) a vector.
            cos_theta_o: (K,) cosines of the angle between normal and camera, in (0, 1].

        Returns:
            (K, 3) the reflected share.
        """
        return np.asarray(material[RHO_D] + lobe_albedo(self, material, cos_theta_o)[:, None])


@dataclass(frozen=True)
class Ggx:
    """The microfacet model of glTF 2.0 without metal: ``base (1 - F) / pi + F D V``.

    ``F`` is Schlick's Fresnel term; vectors of ``base`` (3), ``f0``, ``alpha``.

    Attributes:
        f90: Of the Fresnel term at the horizon; None for ``f0`` at every angle.
    """

    f90: float | None = 1.0

    @property
    def name(self) -> str:
        """``ggx``."""
        return "ggx"

    @property
    def parameters(self) -> tuple[BrdfParameter, ...]:
        """``base`` (3, linear sRGB), ``f0`` at normal incidence and the GGX width ``alpha``."""
        names = ("base r", "base g", "base b", "f0", "alpha")
        lowest = (0.0, 0.0, 0.0, 0.0, SMALLEST_ALPHA)
        return tuple(map(BrdfParameter, names, lowest, (1.0, 1.0, 1.0, 1.0, 1.0)))

    def evaluate(self, material: Array, omega_i: Array, omega_o: Array) -> Array:
        """Evaluate the BRDF; numpy.

        Args:
            material: (..., 5) vectors.
            omega_i: (..., 3) directions of incidence.
            omega_o: (..., 3) directions to the camera.

        Returns:
            (..., 3) in 1/sr; 0 where a direction lies below the surface.
        """
        fresnel = self.fresnel(material[..., F0], omega_i, omega_o)
        above = (omega_i[..., 2] > 0) & (omega_o[..., 2] > 0)
        diffuse = material[..., BASE] * (1 - fresnel)[..., None] / math.pi
        lobe = fresnel * ggx_lobe(material[..., WIDTH], omega_i, omega_o)
        return np.where(above[..., None], diffuse + lobe[..., None], 0.0)

    def sample(self, material: Array, omega_o: Array, u: Array) -> tuple[Array, Array]:
        """Draw directions of incidence from the specular lobe; numpy.

        Args:
            material: (5,) a vector.
            omega_o: (..., 3) directions to the camera.
            u: (..., 2) uniform in [0, 1).

        Returns:
            (..., 3) directions and (...) their weights ``f_s cos theta_i / density``.
        """
        omega_i = sample_ggx(material[WIDTH], omega_o, u)
        reflected = self.fresnel(material[F0], omega_i, omega_o) * ggx_lobe(
            material[WIDTH], omega_i, omega_o
        )
        density = ggx_density(material[WIDTH], omega_i, omega_o)
        return omega_i, reflected * np.clip(omega_i[..., 2], 0, None) / density

    def albedo(
        self, material: NDArray[np.float64], cos_theta_o: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Integrate the BRDF over light that comes from everywhere above.

        Args:
            material: (5,) a vector.
            cos_theta_o: (K,) cosines of the angle between normal and camera, in (0, 1].

        Returns:
            (K, 3) the reflected share.
        """
        specular = lobe_albedo(self, material, cos_theta_o)
        diffuse = material[BASE] * self._passed(material[F0], cos_theta_o)
        return np.asarray(specular[:, None] + diffuse)

    def fresnel(self, f0: Array, omega_i: Array, omega_o: Array) -> Array:
        """The share that facets between two directions reflect (Schlick 1994).

        Args:
            f0: (...) share at normal incidence.
            omega_i: (..., 3) directions of incidence.
            omega_o: (..., 3) directions to the camera, in the same frame.

        Returns:
            (...) in [0, 1].
        """
        half_dot_o = np.linalg.norm(omega_i + omega_o, axis=-1) / 2
        f90 = f0 if self.f90 is None else self.f90
        return f0 + (f90 - f0) * np.clip(1 - half_dot_o, 0, 1) ** 5

    def _passed(self, f0: float, cos_theta_o: NDArray[np.float64]) -> NDArray[np.float64]:
        """(K, 1) cosine-weighted mean over the hemisphere of what the facets let through."""
        u = sampling.strata()
        radius, turn = np.sqrt(u[:, 0]), 2 * math.pi * u[:, 1]
        omega_i = np.stack(
            [radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - u[:, 0])], axis=-1
        )
        fresnel: NDArray[np.float64] = self.fresnel(
            f0, omega_i, sampling.view_directions(cos_theta_o)
        )
        return np.asarray(1 - fresnel.mean(axis=1, keepdims=True))


MODELS: dict[str, BrdfModel] = {
    **{variant.value: Ward(variant) for variant in WardVariant},
    Ggx().name: Ggx(),
}
"""Every model by its name."""
