# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Joint optimisation of a Ward BRDF and the light from one image and its normals.

In the spirit of Lombardi and Nishino ("Reflectance and natural illumination from a single image",
ECCV 2012; the paper's reference 17): maximum a posteriori over both, with a prior on natural light.
The BRDF is Ward's, the light a small equirectangular map, and the prior a simple one: log radiance
is normal, and differences of neighbouring texels follow a Laplace distribution.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from reflest_core.brdf import srgb
from reflest_core.brdf.parameters import ALPHA, RHO_D, RHO_S
from reflest_core.brdf.sampling import sample_specular, specular_weight
from reflest_core.models.card import ParameterStatistics
from reflest_core.surface.observed_surface import ObservedSurface

Tensor = torch.Tensor
ROWS, COLUMNS = 16, 32


@dataclass(frozen=True)
class Effort:
    """How long the optimiser runs.

    Attributes:
        steps: Steps of Adam from each start.
        starts: Values of ``alpha`` to start from; the best posterior is taken.
        learning_rate: Of Adam.
        strata: Samples of the specular lobe along each axis.
    """

    steps: int = 400
    starts: tuple[float, ...] = (0.02, 0.06, 0.15)
    learning_rate: float = 0.03
    strata: int = 6


@dataclass(frozen=True)
class Prior:
    """Weights of the posterior's terms.

    Attributes:
        noise: Standard deviation of sRGB values in [0, 1].
        log_mean: Mean of the light's log radiance.
        log_stddev: Its standard deviation.
        edge: Typical difference of log radiance between neighbours (a Laplace distribution).
        fit_share: Share of the pixels that count as independent, chosen on a dozen training scenes.
        light_share: Share of the light's texels that count as independent.
    """

    noise: float = 0.05
    log_mean: float = math.log(0.3)
    log_stddev: float = 1.2
    edge: float = 0.25
    fit_share: float = 1 / 50
    light_share: float = 1 / 200


@dataclass(frozen=True)
class OneView:
    """The pixels of one view.

    Attributes:
        colours: (P, 3) float32 sRGB in [0, 1].
        frames: (P, 3, 3) float32 rotations from the world to the local frame.
        omega_o: (P, 3) float32 unit, towards the camera, local frame.
    """

    colours: Tensor
    frames: Tensor
    omega_o: Tensor


def optimise_single_image(
    surface: ObservedSurface, statistics: ParameterStatistics, effort: Effort | None = None
) -> NDArray[np.float64]:
    """Optimise from the view with the most observations, on one thread.

    Args:
        surface: What was observed.
        statistics: Mean and standard deviation of the training set (Ward parameters).
        effort: How long to run; None for the default.

    Returns:
        (5,) Ward parameters.
    """
    effort = effort or Effort()
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        problem = _Problem(fullest_view(surface), statistics, effort, Prior())
        found = [problem.solve(alpha) for alpha in effort.starts]
    finally:
        torch.set_num_threads(threads)
    return min(found, key=lambda pair: pair[0])[1]


def fullest_view(surface: ObservedSurface) -> OneView:
    """The pixels of the view with the most observations.

    Args:
        surface: What was observed.
    """
    view = int(np.bincount(surface.view_indices).argmax())
    rows = np.flatnonzero(surface.view_indices == view)
    voxels = np.searchsorted(surface.offsets, rows, side="right") - 1
    normals = torch.from_numpy(surface.normals[voxels])
    towards = torch.from_numpy(surface.view_centres[view] - surface.positions[voxels])
    frames = _local_frames(normals)
    directions = torch.nn.functional.normalize(towards, dim=-1)
    local = torch.einsum("pij,pj->pi", frames, directions)
    return OneView(torch.from_numpy(surface.colours[rows]).float() / 255, frames, local)


class _Problem:
    def __init__(
        self, view: OneView, statistics: ParameterStatistics, effort: Effort, prior: Prior
    ) -> None:
        self.view, self.effort, self.prior = view, effort, prior
        self.mean = torch.from_numpy(statistics.mean).float()
        self.stddev = torch.from_numpy(statistics.stddev).float()
        polar = (torch.arange(ROWS) + 0.5) * math.pi / ROWS
        azimuth = (0.5 - (torch.arange(COLUMNS) + 0.5) / COLUMNS) * 2 * math.pi
        theta, phi = torch.meshgrid(polar, azimuth, indexing="ij")
        directions = torch.stack(
            [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()], dim=-1
        ).view(-1, 3)
        solid_angles = theta.sin().flatten() * (math.pi / ROWS) * (2 * math.pi / COLUMNS)
        cosines = torch.einsum("pi,qi->pq", view.frames[:, 2], directions).clamp(min=0)
        self.diffuse = cosines * solid_angles / math.pi
        edge = (torch.arange(effort.strata) + 0.5) / effort.strata
        self.strata = torch.stack(torch.meshgrid(edge, edge, indexing="ij"), -1).view(1, -1, 2)

    def solve(self, alpha: float) -> tuple[float, NDArray[np.float64]]:
        """Negative log posterior and Ward parameters, from a start at ``alpha``."""
        albedo = torch.logit(torch.tensor([*self.mean[:4].clamp(0.02, 0.9)]))
        material = torch.cat([albedo, torch.tensor([math.log(alpha)])]).requires_grad_()
        light = torch.full((ROWS, COLUMNS, 3), self.prior.log_mean).requires_grad_()
        optimiser = torch.optim.Adam([material, light], lr=self.effort.learning_rate)
        for _ in range(self.effort.steps):
            optimiser.zero_grad()
            loss = self._negative_log_posterior(material, light)
            loss.backward()  # type: ignore[no-untyped-call]
            optimiser.step()
        with torch.no_grad():
            final = float(self._negative_log_posterior(material, light))
            return final, _ward(material).double().numpy()

    def _negative_log_posterior(self, material: Tensor, light: Tensor) -> Tensor:
        ward, prior = _ward(material), self.prior
        residual = srgb.encode(self._radiance(ward, light.exp())) - self.view.colours
        # A Student-like cost: interreflection and shadows that the model lacks are outliers.
        fit = prior.fit_share * torch.log1p((residual / prior.noise) ** 2).sum()
        level = (((light - prior.log_mean) / prior.log_stddev) ** 2).sum() / 2
        across = (light - light.roll(1, dims=1)).abs().sum()
        down = (light[1:] - light[:-1]).abs().sum()
        natural = prior.light_share * (level + (across + down) / prior.edge)
        likely = (((ward - self.mean) / self.stddev) ** 2).sum() / 2
        posterior: Tensor = fit + natural + likely
        return posterior

    def _radiance(self, ward: Tensor, light: Tensor) -> Tensor:
        """(P, 3) linear radiance; distant light, no shadows."""
        matt = ward[RHO_D] * (self.diffuse @ light.view(-1, 3))
        omega_o = self.view.omega_o[:, None]
        omega_i = sample_specular(ward[ALPHA], omega_o, self.strata)
        weight = specular_weight(ward[RHO_S], omega_i, omega_o)
        world = torch.einsum("pji,psj->psi", self.view.frames, omega_i)
        glossy = (weight[..., None] * _look_up(light, world)).mean(dim=1)
        radiance: Tensor = matt + glossy
        return radiance


def _ward(material: Tensor) -> Tensor:
    return torch.cat([torch.sigmoid(material[:4]), material[4:].exp().clamp(0.002, 0.5)])


def _look_up(light: Tensor, directions: Tensor) -> Tensor:
    """Bilinear radiance (P, S, 3) of an equirectangular map (ROWS, COLUMNS, 3)."""
    padded = torch.cat([light[:, -1:], light, light[:, :1]], dim=1).permute(2, 0, 1)[None]
    azimuth = -torch.atan2(directions[..., 1], directions[..., 0])
    polar = torch.acos(directions[..., 2].clamp(-0.9999, 0.9999))
    grid = torch.stack([azimuth / math.pi * COLUMNS / (COLUMNS + 2), polar * 2 / math.pi - 1], -1)
    found = torch.nn.functional.grid_sample(
        padded, grid[None], padding_mode="border", align_corners=False
    )
    return found[0].permute(1, 2, 0)


def _local_frames(normals: Tensor) -> Tensor:
    """(P, 3, 3) rotations from the world to frames with +z on the normal."""
    is_steep = normals[:, 2:].abs() > 0.9
    helper = torch.where(is_steep, torch.tensor([1.0, 0, 0]), torch.tensor([0, 0, 1.0]))
    tangent = torch.nn.functional.normalize(torch.linalg.cross(helper, normals), dim=-1)
    return torch.stack([tangent, torch.linalg.cross(normals, tangent), normals], dim=1)
