# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""At the end of a capture the viewer shows what a replay of it gives."""

from pathlib import Path

import numpy as np
import pytest

from reflest_core.capture.capture import Capture
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.settings import CaptureSettings
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.fusion.settings import FusionSettings
from reflest_core.viewer.capture_source import CaptureSource
from test.waiting import wait_until

CAPTURE = Path(__file__).parents[3] / "captures" / "table"
LONGEST_SCAN = 600.0
"""Seconds after which something is broken."""


@pytest.fixture(scope="module")
def settings():
    return ReflestSettings(fusion=FusionSettings(voxel_size=0.012))


def opened() -> Capture:
    return open_capture(CAPTURE, settings=CaptureSettings())


@pytest.fixture(scope="module")
def shown(settings):
    source = CaptureSource(CAPTURE, settings, lambda _: opened())
    try:
        wait_until(lambda: not source.state().is_working, "the scan does not end", LONGEST_SCAN)
        state = source.state()
        assert state.scan is not None, state.progress
        assert any(keyframe.found is not None for keyframe in state.keyframes)
        yield state.scan.found
    finally:
        source.close()


def test_the_materials_are_those_of_a_replay_to_the_bit(shown, settings):
    pipeline = Pipeline(settings)
    for frame in opened():
        pipeline.fuse(frame)
    found = pipeline.final_materials()
    assert len(found.materials) > 1
    assert shown.materials == found.materials
    assert np.array_equal(shown.material_ids, found.material_ids)
    assert np.array_equal(shown.rho_d, found.rho_d, equal_nan=True)


def test_materials_estimated_at_keyframes_change_nothing_of_the_final_ones(settings):
    alone, often = Pipeline(settings), Pipeline(settings)
    for frame in opened():
        alone.fuse(frame)
        keyframe = often.fuse(frame).keyframe
        if keyframe is not None and keyframe.surface.voxel_count > 1000:
            often.materials(keyframe)
    assert often.final_materials().materials == alone.final_materials().materials
