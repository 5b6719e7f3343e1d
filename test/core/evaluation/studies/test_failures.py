# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The worst scenes are found, and what is said of them can be counted."""

import dataclasses

import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.evaluation.estimates import SceneEstimates
from reflest_core.evaluation.shown_scenes import shown
from reflest_core.evaluation.statistics.scene_measures import MEASURES, measured, unusual
from reflest_core.evaluation.studies.failures import find_failures
from reflest_core.light.light_map import LightMap
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.models.card import ParameterStatistics
from reflest_core.training.data.sample import Sample
from test.core.surfaces import sphere_surface
from test.core.training.scenes import LIGHTS, learnable_samples, stored_scene

STATISTICS = ParameterStatistics(np.full(5, 0.3), np.array([0.2, 0.2, 0.2, 0.3, 0.05]))
WARD = np.array([0.2, 0.4, 0.6, 0.1, 0.1])


def light(colours, share=1.0):
    """Every direction up to a height seen once, in ``colours`` (one or for each texel)."""
    directions = octahedral_directions(96).reshape(-1, 3)
    seen = directions[:, 2] <= 2 * share - 1
    found = LightMap()
    found.add(directions[seen], np.broadcast_to(np.uint8(colours), (seen.sum(), 3)))
    return found.observed()


def lit(background, **changes):
    surface = dataclasses.replace(sphere_surface(40, 20), light=background, **changes)
    return Sample(surface, WARD, "room", 0)


def test_the_share_of_light_seen_is_that_of_the_sphere():
    assert measured(lit(light([90, 90, 90], share=0.25)))["light_seen"] == pytest.approx(
        0.25, abs=0.02
    )
    assert measured(lit(light([90, 90, 90])))["light_clipped"] == 0


def test_overexposed_light_and_surface_are_counted():
    values = measured(lit(light([255, 255, 255])))
    assert values["light_clipped"] == pytest.approx(1)
    assert values["room_brightness"] == pytest.approx(1)
    colours = np.zeros_like(sphere_surface(40, 20).colours)
    colours[: len(colours) // 4, 1] = 255
    values = measured(lit(light([20, 20, 20]), colours=colours))
    assert values["surface_clipped"] == pytest.approx(0.25, abs=0.01)
    assert values["surface_brightness"] == 0
    assert values["room_brightness"] == pytest.approx(srgb.decode(np.array(20 / 255)), rel=1e-3)


def test_a_scene_is_unusual_only_in_the_worst_tenth():
    usual = {measure.name: 0.5 for measure in MEASURES}
    of_split = [{**usual, "light_seen": 0.01 * k} for k in range(100)]
    (sentence,) = unusual(of_split[5], of_split)
    assert sentence == "only 5% of the directions around were seen (more in 94% of the scenes)"
    assert unusual(of_split[20], of_split) == []
    high = [{**usual, "surface_clipped": 0.01 * k} for k in range(100)]
    (sentence,) = unusual(high[97], high)
    assert sentence.startswith("97% of the surface's observations were overexposed (fewer in 97%")


def test_the_worst_come_first_with_reasons_that_follow_from_the_figures():
    scenes = [
        stored_scene(sample, "unseen", k, LIGHTS[k % 2])
        for k, sample in enumerate(learnable_samples(14, seed=3))
    ]
    samples = [shown(scene) for scene in scenes]
    wards = np.stack([sample.ward for sample in samples])
    wards[4, 4] += 0.3
    wards[9, :3] += 0.5
    stddev = np.full_like(wards, 0.01)
    stddev[4] = 0.2
    statuses = ["OK"] * len(samples)
    statuses[4] = "UNCERTAIN_GLOSS"
    found = find_failures(SceneEstimates(wards, stddev, statuses), scenes, samples, STATISTICS)
    assert [failure["index"] for failure in found["failures"][:2]] == [4, 9]
    assert len(found["failures"]) == 10
    first, second = found["failures"][:2]
    assert first["error"] == pytest.approx(0.3 / 0.05 / np.sqrt(5))
    assert first["reasons"][0] == "alpha holds 100% of the squared error"
    assert first["reasons"][-1].startswith("foreseen: by its own deviations an error of ")
    assert first["reasons"][-1].endswith("with status UNCERTAIN_GLOSS")
    assert second["reasons"][0] == "rho_d holds 100% of the squared error"
    assert second["reasons"][-1].startswith("not foreseen")
    assert any("other 6 scenes in" in reason for reason in first["reasons"])
    assert found["without_them"] == pytest.approx(0, abs=1e-9)
