# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How a scan goes on, or not, after a clock jump, in another region and from a file."""

import dataclasses
import json

import numpy as np
import pytest

from reflest_core.capture.refusal import FrameRefused, RefusalCause
from reflest_core.estimation.scanner import Scanner
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
def scanner():
    scanner = Scanner(SETTINGS)
    for frame in FRAMES[:6]:
        scanner.fuse(frame)
    return scanner


def test_a_restarted_clock_keeps_the_scan_and_takes_any_stamp(scanner):
    voxels, views = scanner.scan.voxel_count, scanner.scan.view_count
    with pytest.raises(FrameRefused) as refused:
        scanner.fuse(FRAMES[0])
    assert refused.value.cause is RefusalCause.TIME_BACKWARDS
    scanner.restart_clock()
    again = scanner.fuse(FRAMES[0])
    assert again.keyframe is not None
    assert scanner.scan.view_count == views
    assert scanner.scan.voxel_count >= voxels
    with pytest.raises(FrameRefused):
        scanner.fuse(FRAMES[0])


def test_another_region_empties_the_scan_and_the_same_one_does_not(scanner):
    voxels = scanner.scan.voxel_count
    scanner.set_region(SETTINGS.region)
    assert scanner.scan.voxel_count == voxels > 0
    upper = RegionSettings("box", (0.0, 0.0, 0.15), (0.3, 0.3, 0.3))
    scanner.set_region(upper)
    assert scanner.scan.region_settings == upper
    assert scanner.scan.voxel_count == scanner.scan.view_count == 0
    assert scanner.snapshot().T_world_camera is None
    for frame in FRAMES:
        scanner.fuse(frame)
    assert 0 < scanner.scan.voxel_count < voxels
    height = scanner.scan.snapshot().positions[:, 2]
    assert height.min() > -2 * SETTINGS.fusion.voxel_size


def test_a_loaded_scan_knows_its_frames_and_takes_any_stamp(scanner, tmp_path):
    path = tmp_path / "scan.reflest"
    expected = scanner.snapshot()
    assert (expected.frame_id, expected.world_frame_id) == ("camera", "map")
    scanner.save(path)
    other = Scanner(SETTINGS)
    other.load(path)
    loaded = other.snapshot()
    assert (loaded.frame_id, loaded.world_frame_id) == ("camera", "map")
    assert loaded.stamp_ns == expected.stamp_ns
    found, before = other.estimate(loaded).to_json(), scanner.estimate(expected).to_json()
    # How frames agree is known of those that were fused since the load alone.
    assert found.pop("depth_agreement") is None
    assert before.pop("depth_agreement") > 0.5
    assert found == before
    other.fuse(FRAMES[0])


def test_a_file_without_names_of_frames_is_read(scanner, tmp_path):
    path = tmp_path / "scan.reflest"
    scanner.save(path)
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    header = json.loads(str(arrays["header"]))
    del header["frame_id"], header["world_frame_id"]
    with path.open("wb") as file:
        np.savez(file, **{**arrays, "header": np.array(json.dumps(header))})
    scanner.load(path)
    assert scanner.snapshot().world_frame_id == ""


def test_fill_is_the_share_of_the_fullest_part(scanner):
    scan = scanner.scan
    shares = [part.count / part.capacity for part in (scan.volume, scan.store, scan.views)]
    assert scan.fill == max(shares) > 0.0
    scanner.reset()
    assert scan.fill == 0.0
