# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Estimates are the stored ones, up to rounding: replays those of 0.2.0, scenes those of 0.1.0.

The stored file names version, commit and command. Processors differ in the last digits of float32
arithmetic; ``scripts/compare_checkouts.py`` compares two checkouts on one machine to the bit.
"""

import json
from pathlib import Path

import numpy as np
import pytest

from reflest_core.capture.open_capture import open_capture
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.evaluation.quick_check import QUICK_SET
from reflest_core.models.predictor import Predictor
from reflest_core.training.data.sample_file import read_samples

STORED = json.loads((Path(__file__).parent / "stored" / "values.json").read_text())
CAPTURE = Path(__file__).parents[2] / "captures" / "glossy-red"
ROUNDING = 2e-3
"""Of a value and of one standard unit: far below any deviation that an estimate states."""
TRUE_ALPHA, CLOSE = 0.06, 0.006
COUNTS = ("voxel_count", "observation_count", "view_count")


@pytest.mark.parametrize("model", STORED["estimates"])
def test_replayed_estimates_are_those_of_the_stored_version(model):
    pipeline = Pipeline(ReflestSettings(estimation=EstimationSettings(model=model)))
    first = None
    for frame in open_capture(CAPTURE):
        keyframe = pipeline.fuse(frame).keyframe
        if keyframe is not None and first is None:
            first = pipeline.estimate(keyframe).to_json()
    final = pipeline.estimate(pipeline.snapshot()).to_json()
    for found, stored in zip((first, final), STORED["estimates"][model].values(), strict=True):
        for name, value in stored.items():
            if name in COUNTS or value is None or value == [None] * 3:
                assert found[name] == value, name
            else:
                np.testing.assert_allclose(found[name], value, ROUNDING, 1e-5, err_msg=name)
    if model == "lightnet":
        assert abs(final["alpha"] - TRUE_ALPHA) < CLOSE


@pytest.mark.parametrize("model", STORED["quick_set"])
def test_estimates_of_synthetic_scenes_are_those_of_the_stored_version(model):
    samples = read_samples(QUICK_SET)
    samples = samples[0] if isinstance(samples, tuple) else samples
    predictor = Predictor(model)
    found = [predictor.predict(sample.surface).ward for sample in samples[::80]]
    np.testing.assert_allclose(found, STORED["quick_set"][model], ROUNDING, 1e-5)
