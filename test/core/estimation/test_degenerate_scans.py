# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Scans that show no material, such as with a cap on the lens: never OK, never sure."""

from __future__ import annotations

import numpy as np
import pytest

from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.models.registry import networks
from test.core.lit_surfaces import lit
from test.core.surfaces import patch_surface

SCANS = {
    "black": lambda towards, rng: np.zeros((len(towards), 3)),
    "almost black": lambda towards, rng: np.ones((len(towards), 3)),
    "white": lambda towards, rng: np.full((len(towards), 3), 255),
    "noise": lambda towards, rng: rng.integers(0, 256, (len(towards), 3)),
    "half overexposed": lambda towards, rng: (
        np.where(rng.random((len(towards), 1)) < 0.55, 255, 120) * np.ones(3)
    ),
}


MODELS = [network.models[0].name for network in networks().values()]
"""One of each network."""


@pytest.fixture(scope="module", params=MODELS)
def estimator(request):
    return Estimator(EstimationSettings(model=request.param))


@pytest.mark.parametrize("scan", SCANS)
def test_it_is_never_ok_and_never_sure(estimator, scan):
    estimate = estimator.estimate(lit(patch_surface(SCANS[scan], edge=40)), 0, "")
    assert estimate.status is not EstimateStatus.OK
    assert "the surface's" in estimate.status_text
    usual = estimator.predictor.card.statistics["ward"].stddev
    for stated, of_all in zip(
        (*estimate.rho_d_stddev, estimate.rho_s_stddev, estimate.alpha_stddev), usual, strict=True
    ):
        assert np.isnan(stated) or stated >= of_all * 0.999
