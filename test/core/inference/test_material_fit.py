# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""One material of the whole surface, from what every observation and lobe say."""

import numpy as np
import pytest

from reflest_core.inference.material_fit import fit_material

K, TRUE, RHO_S = 8, 3, 0.3
RHO_D = np.array([0.5, 0.2, 0.1])


def observed(seed=0, count=400):
    rng = np.random.default_rng(seed)
    lobes = rng.gamma(1.0, 1.0, (count, K, 3)).astype(np.float32)
    apparent = (RHO_D + RHO_S * lobes[:, TRUE]).astype(np.float32)
    return apparent, lobes, np.ones((count, 3), np.float32)


def test_the_material_is_found():
    fit = fit_material(*observed())
    np.testing.assert_allclose(fit.albedo[TRUE], RHO_D, atol=0.01)
    assert fit.gloss[TRUE] == pytest.approx(RHO_S, abs=0.01)
    assert fit.weight.argmax() == TRUE


def test_highlights_that_are_wrongly_expected_do_not_decide():
    """Lamps of the completed light are blurred: some lobes see them that in truth do not."""
    apparent, lobes, weight = observed()
    lobes = lobes.copy()
    lobes[::15] += 60.0
    fit = fit_material(apparent, lobes, weight)
    np.testing.assert_allclose(fit.albedo[TRUE], RHO_D, atol=0.05)
    assert fit.gloss[TRUE] == pytest.approx(RHO_S, abs=0.05)
    assert fit.weight.argmax() == TRUE
