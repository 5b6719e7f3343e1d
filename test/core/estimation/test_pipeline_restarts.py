# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How a scan goes on, or not, after a clock jump, in another region and from a file."""

import dataclasses
import json

import numpy as np
import pytest

from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import EstimationSettings, ReflestSettings
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from test.core.fusion.analytic_scene import orbit_frames

SETTINGS = ReflestSettings(
    fusion=FusionSettings(voxel_size=0.01, max_depth=1.0, memory_budget_mb=16.0),
    region=RegionSettings("box", (0.0, 0.0, 0.0), (0.3, 0.3, 0.3)),
    estimation=EstimationSettings(model="hemicnn"),
)
FRAMES = [
    dataclasses.replace(frame, frame_id="camera", world_frame_id="map")
    for frame in orbit_frames(12)
]


@pytest.fixture
def pipeline():
    pipeline = Pipeline(SETTINGS)
    for frame in FRAMES[:6]:
        pipeline.fuse(frame)
    return pipeline


def test_a_restarted_clock_keeps_the_scan_and_takes_any_stamp(pipeline):
    voxels, views = pipeline.scan.voxel_count, pipeline.scan.view_count
    with pytest.raises(FrameRefused) as refused:
        pipeline.fuse(FRAMES[0])
    assert refused.value.cause is RefusalCause.TIME_BACKWARDS
    pipeline.restart_clock()
    again = pipeline.fuse(FRAMES[0])
    assert again.keyframe is not None
    assert pipeline.scan.view_count == views
    assert pipeline.scan.voxel_count >= voxels
    with pytest.raises(FrameRefused):
        pipeline.fuse(FRAMES[0])


def test_another_region_empties_the_scan_and_the_same_one_does_not(pipeline):
    voxels = pipeline.scan.voxel_count
    pipeline.set_region(SETTINGS.region)
    assert pipeline.scan.voxel_count == voxels > 0
    upper = RegionSettings("box", (0.0, 0.0, 0.15), (0.3, 0.3, 0.3))
    pipeline.set_region(upper)
    assert pipeline.scan.region_settings == upper
    assert pipeline.scan.voxel_count == pipeline.scan.view_count == 0
    assert pipeline.snapshot().T_world_camera is None
    for frame in FRAMES:
        pipeline.fuse(frame)
    assert 0 < pipeline.scan.voxel_count < voxels
    height = pipeline.scan.snapshot().positions[:, 2]
    assert height.min() > -2 * SETTINGS.fusion.voxel_size


def test_a_loaded_scan_knows_its_frames_and_takes_any_stamp(pipeline, tmp_path):
    path = tmp_path / "scan.reflest"
    expected = pipeline.snapshot()
    assert (expected.frame_id, expected.world_frame_id) == ("camera", "map")
    pipeline.save(path)
    other = Pipeline(SETTINGS)
    other.load(path)
    loaded = other.snapshot()
    assert (loaded.frame_id, loaded.world_frame_id) == ("camera", "map")
    assert loaded.stamp_ns == expected.stamp_ns
    found, before = other.estimate(loaded).to_json(), pipeline.estimate(expected).to_json()
    # How frames agree is known of those that were fused since the load alone.
    assert found.pop("depth_agreement") is None
    assert before.pop("depth_agreement") > 0.5
    assert found == before
    other.fuse(FRAMES[0])


def test_a_file_without_names_of_frames_is_read(pipeline, tmp_path):
    path = tmp_path / "scan.reflest"
    pipeline.save(path)
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    header = json.loads(str(arrays["header"]))
    del header["frame_id"], header["world_frame_id"]
    with path.open("wb") as file:
        np.savez(file, **{**arrays, "header": np.array(json.dumps(header))})
    pipeline.load(path)
    assert pipeline.snapshot().world_frame_id == ""


def test_fill_is_the_share_of_the_fullest_part(pipeline):
    scan = pipeline.scan
    shares = [part.count / part.capacity for part in (scan.volume, scan.store, scan.views)]
    assert scan.fill == max(shares) > 0.0
    pipeline.reset()
    assert scan.fill == 0.0
