# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Teaching ``lightnet``: from looks whose light is known in part, to say how sure it is."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

import numpy as np
import torch

from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.brdf.parameters import WardVariant
from reflest_core.models.calibration import Calibration
from reflest_core.models.lightnet.network import LightNet
from reflest_core.models.normalisation import WARD_NAMES, ParameterStatistics
from reflest_core.models.weights import WeightsCard, save_weights
from reflest_core.training.light.ablation import check_parts
from reflest_core.training.light.calibration import fitted_calibration
from reflest_core.training.light.light_batches import LightBatch, light_batches
from reflest_core.training.light.light_data import LightData
from reflest_core.training.light.likelihood import likelihood_loss
from reflest_core.training.light.measured_looks import MeasuredLooks
from reflest_core.training.light.measuring import measured
from reflest_core.training.light.shadings import Shadings
from reflest_core.training.recipe import Recipe
from reflest_core.training.run_folder import RunFolder
from reflest_core.training.weight_average import Weights

FIGURES = "held_out.json"
"""Errors and intervals on validation and under the lights held out, by this training or others."""


class LightCourse:
    """A :class:`~reflest_core.training.course.Course` for ``lightnet``.

    ``held_out``: what other trainings erred under lights that they held out, to calibrate on;
    without, the own held-out looks serve, where there are any.
    """

    def __init__(
        self,
        recipe: Recipe,
        data: LightData,
        device: torch.device,
        held_out: MeasuredLooks | None = None,
    ) -> None:
        check_parts(recipe.without)
        self.recipe, self.data, self.device = recipe, data, device
        self.held_out = held_out
        ward = data.training.ward.astype(np.float64)
        labcd = np.stack([ward_to_labcd(one) for one in ward])
        self.both_statistics = {
            "ward": ParameterStatistics.of(ward),
            "labcd": ParameterStatistics.of(labcd),
        }
        self.statistics = self.both_statistics["ward"]
        self._mean, self._stddev = (
            torch.from_numpy(values).float().to(device)
            for values in (self.statistics.mean, self.statistics.stddev)
        )

    def make(self) -> torch.nn.Module:
        """An untrained network."""
        return LightNet().to(self.device)

    def batches(self, first: int, parts: Sequence[int]) -> Iterator[LightBatch]:
        """See :func:`~reflest_core.training.light.light_batches.light_batches`."""
        return light_batches(self.data.training, self.recipe, first, parts, self.device)

    def loss(self, network: torch.nn.Module, batch: LightBatch) -> torch.Tensor:
        """The likelihood of the truth, or its squared error without the uncertainty; in float32."""
        reduced = self.recipe.precision == "bfloat16"
        with torch.autocast(self.device.type, torch.bfloat16, enabled=reduced):
            means, log_variances = network(**batch.look)
        means, log_variances = means.float(), log_variances.float()
        truth = (batch.ward - self._mean) / self._stddev
        if "uncertainty" in self.recipe.without:
            # All outputs take part, as processes that train together ask for.
            squared: torch.Tensor = ((means - truth) ** 2).mean() + 0.0 * log_variances.sum()
            return squared
        return likelihood_loss(means, log_variances, truth)

    def rmse(self, module: torch.nn.Module) -> float:
        """See :attr:`MeasuredLooks.criterion`."""
        return self._measured(module, self.data.validation).criterion

    def save(self, best: Weights, folder: RunFolder) -> None:
        """The weight file, calibrated; its figures; and what it measured under held-out light."""
        module = self.make()
        module.load_state_dict(best)
        module.eval()
        splits = {"validation": self._measured(module, self.data.validation)}
        held_out = self.held_out
        if self.data.held_out is not None:
            held_out = self._measured(module, self.data.held_out)
            held_out.save(folder.path)
        if held_out is not None:
            splits["held_out"] = held_out
        calibration = Calibration() if held_out is None else fitted_calibration(held_out)
        described = {
            **self.recipe.describe(),
            "data": self.data.described,
            "calibrated_under": [] if held_out is None else held_out.lights,
        }
        card = WeightsCard(
            "lightnet",
            "ward",
            WardVariant.WARD_1992,
            self.both_statistics,
            described,
            calibration,
        )
        save_weights(folder.weights, best, card, eight_bit=False)
        figures = {
            "parameters": WARD_NAMES,
            "recipe": described,
            "stddev_factors": calibration.factors.tolist(),
            "stddev_powers": calibration.powers.tolist(),
            "splits": {name: looks.figures(calibration) for name, looks in splits.items()},
        }
        (folder.path / FIGURES).write_text(json.dumps(figures, indent=1) + "\n")

    def _measured(self, module: torch.nn.Module, looks: Shadings) -> MeasuredLooks:
        return measured(module, looks, self.statistics, self.recipe.without, self.device)
