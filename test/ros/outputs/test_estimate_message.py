# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The message holds exactly the estimate's fields, and gives back what it was given."""

from __future__ import annotations

import dataclasses
import math

import pytest
from view_input import ESTIMATE

from reflest_core.estimation.estimate import SCHEMA_VERSION, BrdfEstimate, EstimateStatus
from reflest_ros.msg import BrdfEstimate as BrdfEstimateMessage
from reflest_ros.outputs.estimate_message import (
    estimate_from_message,
    estimate_to_message,
    unknown_message,
)


def test_message_and_estimate_have_the_same_fields():
    own = {field.name for field in dataclasses.fields(BrdfEstimate)}
    sent = set(BrdfEstimateMessage.get_fields_and_field_types())
    assert sent == own - {"stamp_ns", "frame_id"} | {"header"}


def test_status_constants_are_the_estimates():
    for status in EstimateStatus:
        assert getattr(BrdfEstimateMessage, f"STATUS_{status.name}") == status


def test_round_trip_is_exact_and_unknown_stays_nan():
    back = estimate_from_message(estimate_to_message(ESTIMATE))
    assert back.to_json() == ESTIMATE.to_json()
    assert back.stamp_ns == ESTIMATE.stamp_ns
    assert back.rho_s_stddev != back.rho_s_stddev
    assert back.status is EstimateStatus.LOW_COVERAGE


@pytest.mark.parametrize("message", [BrdfEstimateMessage(), unknown_message()])
def test_a_message_without_an_estimate_is_not_ok(message):
    assert estimate_from_message(message).status is EstimateStatus.UNKNOWN


def test_the_unknown_estimate_holds_no_number_that_could_be_used():
    sent = unknown_message()
    numbers = [sent.rho_s, sent.alpha, sent.c, sent.d, sent.coverage, *sent.rho_d, *sent.lab]
    assert all(math.isnan(number) for number in numbers)
    assert sent.schema_version == SCHEMA_VERSION
