# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Weights that no training has touched, for tests of the way from scan to numbers."""

import numpy as np
import torch

from reflest_core.brdf.parameters import WardVariant
from reflest_core.models.card import Calibration, ParameterStatistics
from reflest_core.models.registry import network_of_model
from reflest_core.models.weights import WeightsCard, save_weights

USUAL = ParameterStatistics(
    np.array([0.25, 0.25, 0.25, 0.3, 0.1]), np.array([0.2, 0.2, 0.2, 0.3, 0.06])
)


def untrained(model, folder, calibration=None):
    """Path of the weight file of a model's network as it is first made, always the same."""
    network = network_of_model(model)
    path = folder / f"untrained-{network.name}.safetensors"
    with torch.random.fork_rng():
        torch.manual_seed(7)
        module = network.module()
    card = WeightsCard(
        network.name,
        "ward",
        WardVariant.WARD_1992,
        {"ward": USUAL, "labcd": USUAL},
        {},
        calibration or Calibration(),
    )
    save_weights(path, module.state_dict(), card, eight_bit=False)
    return path


def untrained_lightnet(folder, calibration=None):
    """The same for the network that knows the light."""
    return untrained("lightnet", folder, calibration)
