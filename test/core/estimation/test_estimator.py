# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The estimator: physical values, consistent twins, reasons instead of guesses, repeatable bits."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from reflest_core.brdf.gloss import ward_to_labcd
from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.estimator import Estimator, NoEstimate
from reflest_core.estimation.physical_ward import physical_ward
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.models.registry import shipped_models
from test.core.lit_surfaces import lit
from test.core.surfaces import sphere_surface, without_observations

SURFACE = lit(sphere_surface(voxels=1000))


@pytest.mark.parametrize("model", shipped_models())
def test_an_estimate_is_physical_consistent_and_repeats_bit_for_bit(model):
    settings = EstimationSettings(model=model)
    estimate, again = (Estimator(settings).estimate(SURFACE, 42, "camera") for _ in range(2))
    assert estimate.to_json() == again.to_json()
    assert max(estimate.rho_d) + estimate.rho_s <= 1 + 1e-9
    assert estimate.alpha > 0
    ward = np.array([*estimate.rho_d, estimate.rho_s, estimate.alpha])
    np.testing.assert_allclose(
        [*estimate.lab, estimate.c, estimate.d], ward_to_labcd(ward), rtol=1e-12
    )
    assert estimate.model_id.startswith(f"{model}/")
    assert estimate.ward_variant == "ward-1992"
    assert (estimate.stamp_ns, estimate.frame_id) == (42, "camera")
    assert estimate.voxel_count == 1000
    assert estimate.observation_count == len(SURFACE.colours)
    assert estimate.view_count == 40
    assert estimate.status is EstimateStatus.OK


def test_colours_change_the_estimate():
    estimator = Estimator(EstimationSettings())
    red = lit(sphere_surface(colour=lambda direction, normal: (200, 20, 20)))
    blue = lit(sphere_surface(colour=lambda direction, normal: (20, 20, 200)))
    red_d, blue_d = (estimator.estimate(s, 0, "").rho_d for s in (red, blue))
    assert red_d[0] - red_d[2] > blue_d[0] - blue_d[2]


def test_too_few_voxels_give_the_reason_and_the_knob():
    estimator = Estimator(EstimationSettings(min_voxels=10))
    with pytest.raises(NoEstimate, match=r"0 voxels.*min_voxels is 10.*voxel_size.*intrinsics"):
        estimator.estimate(without_observations(SURFACE), 0, "")
    unseen = dataclasses.replace(
        SURFACE,
        offsets=np.zeros_like(SURFACE.offsets),
        colours=SURFACE.colours[:0],
        view_indices=SURFACE.view_indices[:0],
    )
    with pytest.raises(NoEstimate, match="0 voxels"):
        estimator.estimate(unseen, 0, "")


def test_few_voxels_and_low_coverage_are_marked():
    few = without_observations(SURFACE, 15)
    assert Estimator(EstimationSettings()).estimate(few, 0, "").status is EstimateStatus.FEW_VOXELS
    strict = Estimator(EstimationSettings(low_coverage=0.99))
    low = strict.estimate(SURFACE, 0, "")
    assert low.status is EstimateStatus.LOW_COVERAGE
    assert "99%" in low.status_text


def test_unknown_values_become_null_in_json():
    settings = EstimationSettings(model="grouplet-fast")
    record = Estimator(settings).estimate(SURFACE, 5, "c").to_json()
    assert record["latency"] is None
    assert record["rho_d_stddev"] == [None, None, None]
    assert record["header"] == {"stamp_ns": 5, "frame_id": "c"}
    assert record["status"] == EstimateStatus.OK


@given(arrays(np.float64, 5, elements=st.floats(-5, 5)))
def test_physical_ward_is_within_every_range_and_leaves_physical_values_alone(ward):
    physical = physical_ward(ward)
    assert (physical[:3] >= 0).all()
    assert physical[3] >= 0
    assert physical[:3].max() + physical[3] <= 1 + 1e-12
    assert physical[4] >= 0.001
    np.testing.assert_allclose(physical_ward(physical), physical, rtol=1e-12)
    assert all(math.isfinite(value) for value in physical)
