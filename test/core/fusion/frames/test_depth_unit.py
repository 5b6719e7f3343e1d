# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Depth in a wrong unit is refused, or warned of, with the likely unit and the parameter."""

from dataclasses import replace

import numpy as np
import pytest

from reflest_core.api.scanner import Scanner
from reflest_core.capture.open_capture import open_capture
from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.estimation.estimate import EstimateStatus
from reflest_core.estimation.estimator import NoEstimate
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings
from reflest_core.fusion.frames.depth_unit import mistake_of, unit_hint

CAPTURES = ("captures/glossy-red", "captures/table")
PARAMETER = "multiply capture.depth_scale (Scanner's depth_scale) by "


@pytest.fixture(scope="module")
def captures():
    """Every second frame of the shipped captures; their median depth is 0.5 m."""
    return {name: list(open_capture(name))[::2] for name in CAPTURES}


def misread(frames, factor):
    return [replace(frame, depth=frame.depth * np.float32(factor)) for frame in frames]


@pytest.mark.parametrize("name", CAPTURES)
@pytest.mark.parametrize(
    ("factor", "unit", "change"),
    [
        (10.0, "tenths of a millimetre read as millimetres", "0.1 or 0.2"),
        (100.0, "centimetres read as metres", "0.01"),
        (1000.0, "millimetres read as metres", "0.001"),
    ],
)
def test_depth_that_is_too_large_is_refused_with_its_unit(captures, name, factor, unit, change):
    (wrong,) = misread(captures[name][:1], factor)
    with pytest.raises(FrameRefused) as refused:
        Pipeline(ReflestSettings()).fuse(wrong)
    assert refused.value.cause is RefusalCause.NO_OVERLAP
    assert unit in str(refused.value)
    assert f"{PARAMETER}{change}, or" in str(refused.value)


@pytest.mark.parametrize("name", CAPTURES)
def test_millimetres_read_as_tenths_are_named_by_refusal_and_status(captures, name):
    pipeline, refusals, fused = Pipeline(ReflestSettings()), [], 0
    for frame in misread(captures[name], 0.1):
        try:
            pipeline.fuse(frame)
            fused += 1
        except FrameRefused as refusal:
            refusals.append(str(refusal))
    assert "millimetres read as tenths of a millimetre" in refusals[0]
    assert f"{PARAMETER}5 or 10, or" in refusals[0]
    try:
        estimate = pipeline.estimate(pipeline.snapshot())
    except NoEstimate as reason:
        text = str(reason)
    else:
        assert estimate.status is EstimateStatus.INCONSISTENT_POSES
        text = estimate.status_text
    assert f"millimetres read as tenths of a millimetre: {PARAMETER}10, or" in text


def test_a_unit_of_tum_read_as_millimetres_is_named_by_the_status(captures):
    pipeline = Pipeline(ReflestSettings())
    for frame in misread(captures["captures/table"][:8], 5.0):
        pipeline.poses.add(frame)
    assert "5 times longer fit the depth" in pipeline.poses.report.problem
    assert "1/5000 m, the unit of TUM RGB-D, read as millimetres" in pipeline.poses.report.problem


def test_integers_with_a_wrong_depth_scale_are_refused_by_the_scanner(captures):
    frame = captures["captures/glossy-red"][0]
    arrays = frame.intrinsics, frame.T_world_camera
    millimetres = np.rint(1000.0 * frame.depth).astype(np.uint16)
    with pytest.raises(FrameRefused, match=r"Scanner's depth_scale\) by 0\.1"):
        Scanner(depth_scale=0.01).add(frame.rgb, millimetres, *arrays)


@pytest.mark.parametrize("median", [0.1, 0.3, 1.0, 2.9])
def test_nothing_is_said_of_usual_depth(median):
    assert unit_hint(median, max_depth=3.0) == ""


def test_depth_that_no_usual_unit_explains_is_to_be_checked():
    assert unit_hint(1e-9, max_depth=3.0).startswith("check its unit (capture.depth_scale")
    assert mistake_of(7.0) == ""
