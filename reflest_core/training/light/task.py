# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Training of ``lightnet`` on simulated scans: its likelihood, its measure, its calibration."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

import numpy as np
import torch

from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.brdf.parameters import WardVariant
from reflest_core.models.card import WARD_NAMES, Calibration, ParameterStatistics, WeightsCard
from reflest_core.models.lightnet.network import LightNet
from reflest_core.models.predictor import LARGEST_LOG_VARIANCE
from reflest_core.models.recipe import Recipe
from reflest_core.models.weights import save_weights
from reflest_core.training.light.ablation import check_parts
from reflest_core.training.light.batches import LightBatch, light_batches, whole_scans
from reflest_core.training.light.calibration import fitted_calibration
from reflest_core.training.light.data import LightData
from reflest_core.training.light.measured_scans import MeasuredScans
from reflest_core.training.light.stored_scans import StoredScans
from reflest_core.training.task import RunFolder
from reflest_core.training.weight_average import Weights

LOG_VARIANCES = (-7.0, 3.0)
BETA = 0.5
"""Each term is weighted by its variance to this power, so that uncertain scenes keep their weight
in the mean (Seitzer et al. 2022, "On the Pitfalls of Heteroscedastic Uncertainty Estimation")."""
SQUARED_SHARE = 0.25
"""Weight of the plain squared error beside it."""
AT_ONCE = 64
"""Scans that pass the network at once while measuring."""
FIGURES = "held_out.json"
"""File of errors and intervals on validation and under the lights that were held out."""


class LightTask:
    """A :class:`~reflest_core.training.task.TrainingTask` for ``lightnet``."""

    def __init__(
        self,
        recipe: Recipe,
        data: LightData,
        device: torch.device,
        held_out: MeasuredScans | None = None,
        statistics: dict[str, ParameterStatistics] | None = None,
    ) -> None:
        """Prepare the training.

        Args:
            recipe: The training's.
            data: Its simulated scans.
            device: Where it is trained.
            held_out: Errors of other trainings under lights that they held out, to calibrate on;
                None calibrates on the scans that this training holds out, where there are any.
            statistics: Those that the starting weights were trained with; None computes them from
                the scans.

        Raises:
            TrainingError: The recipe does without a part that there is not.
        """
        check_parts(recipe.without)
        self.recipe, self.data, self.device = recipe, data, device
        self.held_out = held_out
        self.both_statistics = statistics or _statistics(data.training)
        self.statistics = self.both_statistics["ward"]
        self._mean, self._stddev = (
            torch.from_numpy(values).float().to(device)
            for values in (self.statistics.mean, self.statistics.stddev)
        )

    @property
    def examples(self) -> int:
        """How many training scans there are."""
        return len(self.data.training)

    def make(self) -> torch.nn.Module:
        """Make an untrained network."""
        return LightNet().to(self.device)

    def batches(self, first: int, parts: Sequence[int]) -> Iterator[LightBatch]:
        """See :func:`~reflest_core.training.light.batches.light_batches`.

        Args:
            first: Number of the first minibatch.
            parts: Which parts of each minibatch.
        """
        return light_batches(self.data.training, self.recipe, first, parts, self.device)

    def loss(self, network: torch.nn.Module, batch: LightBatch) -> torch.Tensor:
        """Compute the likelihood loss, or the squared error without uncertainty, in float32.

        Args:
            network: The network.
            batch: The minibatch.
        """
        reduced = self.recipe.precision == "bfloat16"
        with torch.autocast(self.device.type, torch.bfloat16, enabled=reduced):
            means, log_variances = network(**batch.features)
        means, log_variances = means.float(), log_variances.float()
        truth = (batch.ward - self._mean) / self._stddev
        if "uncertainty" in self.recipe.without:
            # All outputs take part, as processes that train together ask for.
            squared: torch.Tensor = ((means - truth) ** 2).mean() + 0.0 * log_variances.sum()
            return squared
        return likelihood_loss(means, log_variances, truth)

    def rmse(self, module: torch.nn.Module) -> float:
        """Measure :attr:`MeasuredScans.criterion` on validation.

        Args:
            module: The network.
        """
        return self._measured(module, self.data.validation).criterion

    def save(self, best: Weights, folder: RunFolder) -> None:
        """Write the calibrated weight file, its figures and the errors under held-out lights.

        Args:
            best: The weights to keep.
            folder: The training's.
        """
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
            "gloss_posterior": True,
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
            "splits": {name: scans.figures(calibration) for name, scans in splits.items()},
        }
        (folder.path / FIGURES).write_text(json.dumps(figures, indent=1) + "\n")

    def _measured(self, module: torch.nn.Module, scans: StoredScans) -> MeasuredScans:
        return measured(module, scans, self.statistics, self.recipe.without, self.device)


def _statistics(scans: StoredScans) -> dict[str, ParameterStatistics]:
    ward = scans.ward.astype(np.float64)
    labcd = np.stack([ward_to_labcd(one) for one in ward])
    return {"ward": ParameterStatistics.of(ward), "labcd": ParameterStatistics.of(labcd)}


def likelihood_loss(
    means: torch.Tensor, log_variances: torch.Tensor, truth: torch.Tensor
) -> torch.Tensor:
    """Compute a Gaussian likelihood in which hard scenes keep their weight.

    Args:
        means: (B, 5), z-scored parameters.
        log_variances: (B, 5).
        truth: (B, 5), z-scored.

    Returns:
        The mean over all of the weighted negative logarithm (Seitzer et al. 2022) and of a share of
        the squared error.
    """
    log_variances = log_variances.clamp(*LOG_VARIANCES)
    squared = (means - truth) ** 2
    negative_log = 0.5 * (log_variances + squared * torch.exp(-log_variances))
    weight = torch.exp(BETA * log_variances.detach())
    return (weight * negative_log).mean() + SQUARED_SHARE * squared.mean()


def measured(
    module: torch.nn.Module,
    scans: StoredScans,
    statistics: ParameterStatistics,
    without: tuple[str, ...],
    device: torch.device,
) -> MeasuredScans:
    """Compare the estimates of every scan with the truth, in float32.

    Args:
        module: The network.
        scans: Simulated scans.
        statistics: The training set's, of the Ward parameters.
        without: Parts of the features that are hidden.
        device: Where the network is.
    """
    means, log_variances = [], []
    for start in range(0, len(scans), AT_ONCE):
        rows = np.arange(start, min(start + AT_ONCE, len(scans)))
        features = {n: tensor.to(device) for n, tensor in whole_scans(scans, rows, without).items()}
        with torch.inference_mode():
            mean, log_variance = module(**features)
        means.append(mean.double().cpu().numpy())
        log_variances.append(log_variance.double().cpu().numpy())
    logs = np.minimum(np.concatenate(log_variances), LARGEST_LOG_VARIANCE)
    truths = statistics.normalise(scans.ward.astype(np.float64))
    errors = np.concatenate(means) - truths
    return MeasuredScans(errors, np.exp(0.5 * logs), scans.views, scans.environment)
