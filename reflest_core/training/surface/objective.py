# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""J = E_d + lambda E_c (Eq. 3) of a minibatch, from z-scored outputs."""

from __future__ import annotations

import numpy as np
import torch

from reflest_core.brdf.gloss import labcd_to_ward, ward_to_labcd
from reflest_core.brdf.half_angle import HalfAngleQuadrature
from reflest_core.brdf.losses import colour_constancy, cube_root, parameter_distance
from reflest_core.brdf.parameters import ALPHA, RHO_D, RHO_S
from reflest_core.models.card import ParameterStatistics
from reflest_core.models.recipe import Recipe
from reflest_core.training.surface.batches import Batch

SMALLEST_ALPHA = 0.01
"""CubeRoot evaluates BRDFs: sharper lobes than this would drown its gradient."""

QUADRATURE = (32, 6, 6)
"""A sixth of the usual nodes: CubeRoot of two SynBRDF materials moves by 0.2 %, at most 1 %."""


class Objective:
    """The recipe's loss, of z-scored outputs."""

    def __init__(
        self, recipe: Recipe, statistics: ParameterStatistics, device: torch.device
    ) -> None:
        """Prepare the loss.

        Args:
            recipe: The training's.
            statistics: The training set's, of the parameters that the loss is written in.
            device: Where the outputs are.
        """
        self.recipe = recipe
        self.mean = torch.from_numpy(statistics.mean.astype(np.float32)).to(device)
        self.stddev = torch.from_numpy(statistics.stddev.astype(np.float32)).to(device)
        self.least = torch.tensor([-torch.inf] * ALPHA + [SMALLEST_ALPHA], device=device)
        made = HalfAngleQuadrature.make(*QUADRATURE)
        self.quadrature = HalfAngleQuadrature(
            made.omega_i.to(device), made.omega_o.to(device), made.weights.to(device)
        )

    def __call__(self, scores: torch.Tensor, batch: Batch) -> torch.Tensor:
        """Compute the mean of J over a batch from the network's outputs (B, 5)."""
        loss = self._data_loss(scores, batch.ward)
        if self.recipe.colour_constancy:
            ward = self._as_ward(scores)
            loss = loss + self.recipe.colour_constancy * colour_constancy(
                ward[:, RHO_D], ward[:, RHO_S], batch.foreground, batch.background
            )
        return loss.mean()

    def _data_loss(self, scores: torch.Tensor, truth: torch.Tensor) -> torch.Tensor:
        if self.recipe.loss == "cuberoot":
            estimate = torch.maximum(self._as_ward(scores), self.least)
            return cube_root(estimate, torch.maximum(truth, self.least), self.quadrature)
        parameters = ward_to_labcd(truth) if self.recipe.parameters == "labcd" else truth
        return parameter_distance(scores, (parameters - self.mean) / self.stddev)

    def _as_ward(self, scores: torch.Tensor) -> torch.Tensor:
        parameters = scores * self.stddev + self.mean
        if self.recipe.parameters == "labcd":
            converted: torch.Tensor = labcd_to_ward(parameters)
            return converted
        return parameters
