# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a ``lightnet`` says of looks, beside the truth."""

from __future__ import annotations

import numpy as np
import torch

from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.models.predictor import LARGEST_LOG_VARIANCE
from reflest_core.training.light.light_batches import whole_looks
from reflest_core.training.light.measured_looks import MeasuredLooks
from reflest_core.training.light.shadings import Shadings

AT_ONCE = 64


def measured(
    module: torch.nn.Module,
    looks: Shadings,
    statistics: ParameterStatistics,
    without: tuple[str, ...],
    device: torch.device,
) -> MeasuredLooks:
    """Estimate from every look, in float32. ``statistics``: the training set's, of Ward."""
    means, log_variances = [], []
    for start in range(0, len(looks), AT_ONCE):
        rows = np.arange(start, min(start + AT_ONCE, len(looks)))
        look = {n: tensor.to(device) for n, tensor in whole_looks(looks, rows, without).items()}
        with torch.inference_mode():
            mean, log_variance = module(**look)
        means.append(mean.double().cpu().numpy())
        log_variances.append(log_variance.double().cpu().numpy())
    logs = np.minimum(np.concatenate(log_variances), LARGEST_LOG_VARIANCE)
    truths = statistics.normalise(looks.ward.astype(np.float64))
    errors = np.concatenate(means) - truths
    return MeasuredLooks(errors, np.exp(0.5 * logs), looks.views, looks.environment)
