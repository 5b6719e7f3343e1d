# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Arrays through the Python API give the estimates of a replay, bit for bit."""

from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

import reflest_core
from reflest_core import ReflestError, Scanner, box, open_capture, sphere
from reflest_core.estimation.pipeline import Pipeline
from reflest_core.estimation.settings import ReflestSettings

CAPTURE = Path(__file__).parents[3] / "captures" / "glossy-red"
REGION = sphere((0.0, 0.0, 0.0), 0.3)


@pytest.fixture(scope="module")
def frames():
    return list(islice(open_capture(CAPTURE), 8))


@pytest.fixture(scope="module")
def scanned(frames):
    scanner = Scanner(region=REGION)
    for frame in frames:
        stamp = frame.stamp_ns / 1e9
        scanner.add(frame.rgb, frame.depth, frame.intrinsics.matrix, frame.T_world_camera, stamp)
    return scanner


def test_arrays_give_the_estimate_of_the_frames_that_they_come_from(frames, scanned):
    pipeline = Pipeline(ReflestSettings(region=REGION))
    for frame in frames:
        pipeline.fuse(frame)
    expected = pipeline.estimate(pipeline.snapshot())
    found = scanned.estimate()
    assert found.rho_d == expected.rho_d
    assert (found.rho_s, found.alpha) == (expected.rho_s, expected.alpha)
    assert found.voxel_count == expected.voxel_count > 500


def test_integers_with_their_scale_are_the_same_scan_as_metres(frames):
    by_scale, by_metres = Scanner(depth_scale=0.001), Scanner()
    for frame in frames[:3]:
        millimetres = np.rint(1000.0 * frame.depth).astype(np.uint16)
        rest = frame.intrinsics.matrix, frame.T_world_camera
        by_scale.add(frame.rgb, millimetres, *rest)
        by_metres.add(frame.rgb, millimetres * np.float32(0.001), *rest)
    assert by_scale.estimate().rho_d == by_metres.estimate().rho_d


def test_the_whole_scan_is_one_material_with_the_estimate_s_values(scanned):
    found = scanned.materials()
    (material,) = found.materials
    estimate = scanned.estimate()
    assert material.estimate.rho_d == estimate.rho_d
    assert material.estimate.alpha == estimate.alpha
    # A quarter of a metre across: its area lies between a disc's and a box's.
    assert 0.02 < material.area < 0.4
    assert found.material(material.id) is material
    assert found.material(material.id + 1) is None
    assert set(found.of_voxels("alpha")) == {np.float32(estimate.alpha)}


def test_a_saved_scan_goes_on_in_another_scanner(scanned, tmp_path):
    scanned.save(tmp_path / "scan.npz")
    other = Scanner(region=REGION)
    other.load(tmp_path / "scan.npz")
    assert other.estimate().rho_d == scanned.estimate().rho_d
    for write in (scanned.save, scanned.export):
        with pytest.raises(ReflestError, match=r"the folder .*nosuch does not exist"):
            write(tmp_path / "nosuch" / "light.hdr")


def test_the_suffix_chooses_what_is_exported(scanned, tmp_path):
    for name in ("surface.glb", "light.hdr"):
        scanned.export(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 100
    with pytest.raises(ReflestError, match=r"no known suffix; known are .*\.gltf"):
        scanned.export(tmp_path / "material.docx")


def test_a_region_is_given_by_its_radius_or_its_edges():
    assert sphere((0.0, 0.0, 1.0), 0.2).size == (0.4, 0.4, 0.4)
    assert box((0.0, 0.0, 1.0), (0.1, 0.2, 0.3)).size == (0.1, 0.2, 0.3)
    with pytest.raises(ReflestError, match="depth_scale"):
        Scanner(depth_scale=-1.0)
    assert set(reflest_core.__all__) <= set(dir(reflest_core))
    with pytest.raises(AttributeError, match="no attribute"):
        _ = reflest_core.Scaner


def test_a_stamp_or_frame_that_cannot_be_leaves_the_scan_as_it_was(frames):
    scanner = Scanner(region=REGION)
    with pytest.raises(ReflestError, match="frame is None: pass a frame"):
        scanner.add_frame(None)
    with pytest.raises(ReflestError, match="within 292 years"):
        scanner.add_frame(replace(frames[0], stamp_ns=2**70))
    with pytest.raises(ReflestError, match="expected nanoseconds"):
        scanner.add_frame(replace(frames[0], stamp_ns=0.5))
    scanner.add_frame(replace(frames[0], stamp_ns=2**63 - 10**9 - 1))
    frame = frames[1]
    arrays = frame.rgb, frame.depth, frame.intrinsics, frame.T_world_camera
    with pytest.raises(ReflestError, match="within 292 years"):
        scanner.add(*arrays)


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: sphere((0.0, 0.0), 1.0), r"centre is \(0.0, 0.0\): expected three numbers"),
        (lambda: sphere((0.0, 0.0, 0.0), 0.0), "radius = 0 m"),
        (lambda: sphere((0.0, 0.0, 0.0), -1.0), "radius = -1 m"),
        (lambda: sphere((0.0, 0.0, 0.0), "1"), "radius is '1': expected a number"),
        (lambda: box((0.0, 0.0, 0.0), (1.0, 0.0, 1.0)), "size = .*every edge above 0"),
        (lambda: box((0.0, 0.0, 0.0), 1.0), "size is 1.0: expected three numbers"),
        (lambda: Scanner(region=[0, 0, 0, 1]), r"region is \[0, 0, 0, 1\]: pass sphere"),
        (lambda: Scanner(voxel_size="5mm"), "voxel_size is '5mm'"),
        (lambda: Scanner(up="z"), "up is 'z'"),
        (lambda: Scanner.load("scan.npz"), "needs a scanner"),
    ],
)
def test_an_argument_of_another_kind_is_one_sentence(make, sentence):
    with pytest.raises(ReflestError, match=sentence):
        make()
