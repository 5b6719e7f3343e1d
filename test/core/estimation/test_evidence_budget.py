# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Estimates that take too long use less evidence and say so; fast ones use all of it."""

import pytest

from reflest_core.estimation.estimator import Estimator
from reflest_core.estimation.evidence_budget import LEAST, EvidenceBudget
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.inference import evidence
from reflest_core.light.completion import complete
from test.core.lit_surfaces import lit
from test.core.surfaces import sphere_surface

SURFACE = lit(sphere_surface(voxels=800, colour=lambda direction, normal: (150, 120, 100)))


class Clock:
    """Seconds that pass only as they are told to."""

    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


def spend(budget, clock, seconds):
    with budget.spending():
        clock.now += seconds


def test_without_a_limit_nothing_is_left_out(clock):
    budget = EvidenceBudget(0.0, clock)
    spend(budget, clock, 1000.0)
    assert budget.share == 1.0
    assert budget.note == ""


def test_the_share_follows_the_time_and_comes_back(clock):
    budget = EvidenceBudget(0.1, clock)
    spend(budget, clock, 0.2)
    assert budget.share == pytest.approx(0.5)
    assert budget.note == ("50% of the evidence was used, to keep within estimation.budget = 0.1 s")
    spend(budget, clock, 0.09)  # within the budget, but with little to spare
    assert budget.share == pytest.approx(0.5)
    spend(budget, clock, 10.0)
    assert budget.share == LEAST
    for _ in range(20):
        spend(budget, clock, 0.01)
    assert budget.share == 1.0
    assert budget.note == ""


def test_an_estimate_that_fails_changes_nothing(clock):
    budget = EvidenceBudget(0.1, clock)

    def fail():
        with budget.spending():
            clock.now += 10.0
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert budget.share == 1.0


def test_a_slow_estimator_uses_less_and_says_so_and_one_without_a_budget_does_not():
    free, hurried = (
        Estimator(EstimationSettings(model="lightnet", budget=budget)) for budget in (0.0, 1e-4)
    )
    first = hurried.estimate(SURFACE, 0, "")
    assert first.to_json() == free.estimate(SURFACE, 0, "").to_json()
    second = hurried.estimate(SURFACE, 0, "")
    assert f"{LEAST:.0%} of the evidence was used" in second.status_text
    assert second.status == first.status
    assert second.to_json() != first.to_json()
    assert free.estimate(SURFACE, 0, "").to_json() == first.to_json()
    # What is left out costs little: the answer is within its own deviation.
    assert abs(second.alpha - first.alpha) < first.alpha_stddev
    for again, once, stddev in zip(second.rho_d, first.rho_d, first.rho_d_stddev, strict=True):
        assert abs(again - once) < stddev


def test_fewer_voxels_give_gloss_but_no_fewer_than_in_training():
    light, occluders = complete(SURFACE.light), evidence.scene_occluders(SURFACE)
    voxels = [
        len(evidence.material_evidence(SURFACE, light, occluders, share).sample.voxels)
        for share in (1.0, 0.5, 0.01)
    ]
    assert voxels == [evidence.SAMPLED, evidence.SAMPLED // 2, evidence.TRAINED]
