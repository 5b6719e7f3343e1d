# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A recorded bag and an untrained network, made once for all tests of the command line."""

import pytest

from reflest_core.estimation.settings import EstimationSettings
from test.core.capture.recording import recording, write_bag
from test.core.weight_files import untrained


@pytest.fixture(scope="session")
def weights(tmp_path_factory):
    """Weights that no training has touched: the path from capture to numbers is under test."""
    return untrained(EstimationSettings().model, tmp_path_factory.mktemp("weights"))


@pytest.fixture(scope="session")
def bag(tmp_path_factory):
    """Twelve frames around a sphere."""
    folder = tmp_path_factory.mktemp("bags") / "bag"
    write_bag(folder, recording(12))
    return folder
