# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Reasons not to trust an estimate: each by its threshold, the most severe first."""

import dataclasses
import re

import pytest

from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.reliability import Evidence, grouped_warnings, warnings_of
from reflest_core.estimation.settings import EstimationSettings
from reflest_core.light.light_knowledge import LightKnowledge
from reflest_core.surface.colour_problems import ColourProblems

SETTINGS = EstimationSettings(low_coverage=0.2, low_light=0.3, clipped_light=0.5)
SURE = {
    "voxels": 48,
    "wanted_voxels": 48,
    "coverage": 0.2,
    "light": LightKnowledge(0.3, 0.5),
}
LONGEST_REASON = "999 voxels of good normals mirror light that was seen, 999 are needed"
LONGEST_NOISE = (
    "the surface's colours are noise (9999% between images, not shared by neighbours): "
    "give more light, or correct the poses"
)
LONGEST_TEXT = 512
"""Of ``status_text`` in the message."""


@pytest.mark.parametrize(
    ("changed", "status", "sentence"),
    [
        ({"voxels": 47}, EstimateStatus.FEW_VOXELS, "47 voxels.*48: scan more"),
        ({"coverage": 0.19}, EstimateStatus.LOW_COVERAGE, "19%.*20%: move around"),
        ({"coverage": 0.1964}, EstimateStatus.LOW_COVERAGE, r"^19\.6% of view.*below 20%: move"),
        ({"coverage": 0.19996}, EstimateStatus.LOW_COVERAGE, r"^19\.996% of view.*below 20%: move"),
        ({"light": LightKnowledge(0.298, 0.0)}, EstimateStatus.LOW_LIGHT, r"^29\.8%.*below 30%:"),
        ({"light": LightKnowledge(0.9, 0.502)}, EstimateStatus.CLIPPED_LIGHT, "^50.2%.*above 50%:"),
        ({"light": LightKnowledge(0.29, 0.0)}, EstimateStatus.LOW_LIGHT, "29%.*30%: look round"),
        ({"light": LightKnowledge(0.0, 0.0)}, EstimateStatus.LOW_LIGHT, "^none.*30%"),
        (
            {"light": LightKnowledge(0.9, 0.51)},
            EstimateStatus.CLIPPED_LIGHT,
            "51%.*50%: lower the exposure",
        ),
        (
            {"colours": ColourProblems(too_dark="all is black")},
            EstimateStatus.LOW_LIGHT,
            "^all is black$",
        ),
        (
            {"colours": ColourProblems(noise="all is noise"), "gloss_problem": "it is dark"},
            EstimateStatus.LOW_LIGHT,
            "^all is noise$",
        ),
        (
            {"colours": ColourProblems(overexposed="all is white")},
            EstimateStatus.CLIPPED_LIGHT,
            "^all is white$",
        ),
        (
            {"gloss_problem": "it is dark"},
            EstimateStatus.UNCERTAIN_GLOSS,
            "determined: it is dark$",
        ),
        (
            {"photometric_error": 1.41},
            EstimateStatus.UNCERTAIN_GLOSS,
            "^rendered, it misses what was observed by 141%: look round",
        ),
    ],
)
def test_each_threshold_is_a_warning_with_what_to_do(changed, status, sentence):
    assert list(warnings_of(Evidence(**SURE), SETTINGS)) == []
    ((found, text),) = warnings_of(Evidence(**{**SURE, **changed}), SETTINGS)
    assert found is status
    assert re.search(sentence, text)


def test_no_light_at_all_is_warned_of_whatever_the_threshold():
    evidence = Evidence(**{**SURE, "light": LightKnowledge(0.0, 0.0)})
    ((status, _),) = warnings_of(evidence, EstimationSettings(low_light=0.0))
    assert status is EstimateStatus.LOW_LIGHT


def test_networks_that_do_not_look_at_the_light_are_not_judged_by_it():
    assert list(warnings_of(Evidence(**{**SURE, "light": None}), SETTINGS)) == []


def test_all_warnings_come_in_the_order_that_the_message_states_and_fit_into_it():
    worst = Evidence(1000, 1001, 0.001, LightKnowledge(0.101, 0.991), gloss_problem=LONGEST_REASON)
    strict = EstimationSettings(low_coverage=0.999, low_light=0.999, clipped_light=0.111)
    found = list(warnings_of(worst, strict))
    assert [status.name for status, _ in found] == [
        "FEW_VOXELS",
        "LOW_COVERAGE",
        "LOW_LIGHT",
        "CLIPPED_LIGHT",
        "UNCERTAIN_GLOSS",
    ]
    assert len("; ".join(sentence for _, sentence in found)) <= LONGEST_TEXT
    worst = dataclasses.replace(worst, colours=ColourProblems(noise=LONGEST_NOISE))
    found = list(warnings_of(worst, strict))
    assert len("; ".join(sentence for _, sentence in found)) <= LONGEST_TEXT


def test_warnings_that_differ_in_numbers_alone_are_joined():
    seen = "of view directions seen, below 15%: move around the object"
    joined = grouped_warnings(
        [(4, f"9% {seen}"), (7, "scan more of the object"), (1, f"12% {seen}"), (9, f"2% {seen}")]
    )
    assert joined == {f"2 to 12% {seen}": [4, 1, 9], "scan more of the object": [7]}


def test_one_warning_is_joined_with_none():
    assert grouped_warnings([(3, "0.5 m of 2.0 m")]) == {"0.5 m of 2.0 m": [3]}
    assert grouped_warnings([]) == {}
