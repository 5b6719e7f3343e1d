# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A recorded bag and an untrained network, made once for all tests of the command line."""

import numpy as np
import pytest
import torch

from reflest_core.brdf.parameters import WardVariant
from reflest_core.models.grouplet import Grouplet
from reflest_core.models.normalisation import ParameterStatistics
from reflest_core.models.weights import WeightsCard, save_weights
from test.core.capture.recording import recording, write_bag


@pytest.fixture(scope="session")
def weights(tmp_path_factory):
    """Weights that no training has touched: the path from capture to numbers is under test."""
    path = tmp_path_factory.mktemp("weights") / "grouplet.safetensors"
    torch.manual_seed(4)
    statistics = ParameterStatistics(np.array([0.3, 0.3, 0.3, 0.1, 0.1]), np.full(5, 0.05))
    card = WeightsCard("grouplet", "ward", WardVariant.WARD_1992, {"ward": statistics}, {})
    save_weights(path, Grouplet().state_dict(), card, eight_bit=False)
    return path


@pytest.fixture(scope="session")
def bag(tmp_path_factory):
    """Twelve frames around a sphere."""
    folder = tmp_path_factory.mktemp("bags") / "bag"
    write_bag(folder, recording(12))
    return folder
