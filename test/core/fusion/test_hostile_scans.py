# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A scan file may come from anywhere: it is used as it is, or refused in one sentence."""

from __future__ import annotations

import dataclasses
import json
import os
import struct
import zipfile

import numpy as np
import pytest

from reflest_core.fusion.memory_budget import MemoryBudgetError
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.scan_file import DamagedScanError, ScanFileError
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.surface.voxel_key import pack_key
from test.core.fusion.analytic_scene import orbit_frames
from test.stress import repeats

SETTINGS = FusionSettings(max_depth=1.0, observations_per_voxel=6, memory_budget_mb=32.0)
REGION = RegionSettings("sphere", (0.0, 0.0, 0.01), (0.3, 0.3, 0.3))
MUTATIONS = repeats(60, 1000)


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """Arrays of a saved scan by name."""
    scan = Scan(SETTINGS, REGION)
    for frame in orbit_frames(24)[:10]:
        scan.fuse(frame)
    path = tmp_path_factory.mktemp("scans") / "good.scan"
    scan.save(path)
    with np.load(path) as file:
        return {name: file[name] for name in file.files}


def write(path, stored, header=None, text=None, **arrays):
    """A scan file with changed arrays and entries of the header, or another header's text."""
    entries = json.loads(str(stored["header"])) | (header or {})
    with path.open("wb") as file:
        np.savez(file, **{**stored, **arrays, "header": np.array(text or json.dumps(entries))})
    return path


def of_fusion(stored, **changed):
    return {"fusion": json.loads(str(stored["header"]))["fusion"] | changed}


@pytest.mark.parametrize(
    "header",
    [
        {"frame_number": float("inf")},
        {"frame_number": -5},
        {"origin": [0.0, 0.0]},
        {"origin": [1e300, 0.0, 0.0]},
        {"origin": "somewhere"},
        {"middle": [0.0, 0.0, "x"]},
        {"middle": [0.0, 0.0, -1e9]},
        {"unchecked_until": 1e300},
        {"unchecked_until": -7},
        {"frame_number": 2**100},
        {"frame_number": 2**31 - 1},
        {"frame_number": 1.5},
        {"exposure_gain": float("nan")},
        {"exposure_gain": 0.0},
        {"last_stamp_ns": "x"},
        {"last_stamp_ns": 2**200},
        {"frame_id": "x" * 5000},
        {"frame_id": 7},
        {"world_frame_id": "a\nend_header\nxx"},
        {"frame_id": "\ud800"},
        {"region": {"shape": "sphere", "centre": "abc", "size": "abc"}},
        {"region": {"shape": "sphere", "centre": [1e308, 0, 0], "size": [1, 1, 1]}},
        {"work_sphere": {"centre": [0, 0], "distance": 1.0, "frames": 1}},
        {"work_sphere": {"centre": "123", "distance": 1.0, "frames": 1}},
        {"work_sphere": {"centre": [0, 0, "1"], "distance": 1.0, "frames": 1}},
        {"work_sphere": {"centre": [1e308, 0, 0], "distance": 1.0, "frames": 1}},
        {"work_sphere": {"centre": [0, 0, 0], "distance": 1e308, "frames": 1}},
        {"work_sphere": {"centre": [0, 0, 0], "distance": -1.0, "frames": 1}},
        {"work_sphere": {"centre": [0, 0, 0], "distance": 1.0, "frames": -1}},
        {"work_sphere": {"centre": [0, 0, 0], "distance": 1.0, "frames": 11}},
        {"work_sphere": {"centre": [0, 0, 0], "distance": 1.0, "frames": 1.5}},
        {"fusion": [1]},
    ],
    ids=str,
)
def test_a_header_that_cannot_be_right_is_refused(stored, tmp_path, header):
    with pytest.raises(DamagedScanError):
        Scan.load(write(tmp_path / "a.scan", stored, header))


@pytest.mark.parametrize("stored_sphere", [[], "x", {}, {"centre": [0, 0, 0], "frames": 1}])
def test_a_work_sphere_that_is_none_is_named(stored, tmp_path, stored_sphere):
    with pytest.raises(DamagedScanError, match="the work sphere has no centre"):
        Scan.load(write(tmp_path / "a.scan", stored, {"work_sphere": stored_sphere}))


@pytest.mark.parametrize(
    "changed",
    [{"threads": 10**9}, {"threads": 1.5}, {"memory_budget_mb": 1e300}, {"evil": 1}],
    ids=str,
)
def test_settings_that_cannot_be_right_are_refused(stored, tmp_path, changed):
    with pytest.raises(DamagedScanError):
        Scan.load(write(tmp_path / "a.scan", stored, of_fusion(stored, **changed)))


def test_a_header_that_is_too_deep_is_refused(stored, tmp_path):
    text = json.dumps({"format": "reflest-scan", "deep": 1}).replace("1", "[" * 100_000)
    with pytest.raises(ScanFileError):
        Scan.load(write(tmp_path / "a.scan", stored, text=text))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("views_centres", np.nan),
        ("views_centres", 1e30),
        ("views_centres", -6000.0),
        ("views_frames", 2**31 - 1),
        ("views_frames", -1),
        ("views_order", -2),
        ("views_order", 2**63 - 1),
        ("views_gains", 0.0),
        ("views_gains", np.inf),
        ("views_foreground", -1.0),
        ("store_positions", np.nan),
        ("store_positions", 1e30),
        ("store_normals", np.nan),
        ("store_normals", 1e30),
        ("store_keys", -1),
        ("store_keys", 2**62),
        ("store_last_seen", 10**6),
        ("volume_tsdf", np.nan),
        ("volume_tsdf", 1e4),
        ("volume_keys", 3),
        ("volume_last_seen", -1),
        ("chunks_view_ids", 60_000),
        ("light_radiance_sum", np.inf),
        ("light_count", -1.0),
    ],
)
def test_one_number_that_cannot_be_right_is_refused(stored, tmp_path, name, value):
    array = stored[name].copy()
    array.reshape(-1)[1] = value
    with pytest.raises(DamagedScanError):
        Scan.load(write(tmp_path / "a.scan", stored, **{name: array}))


@pytest.mark.parametrize("length", [0.0, 1e-30, 0.99, 1.01])
def test_a_normal_that_is_not_of_unit_length_is_refused(stored, tmp_path, length):
    normals = stored["store_normals"].copy()
    normals[1] *= np.float32(length)
    with pytest.raises(DamagedScanError, match="unit length"):
        Scan.load(write(tmp_path / "a.scan", stored, store_normals=normals))


def test_observations_of_a_forgotten_view_are_refused(stored, tmp_path):
    order = stored["views_order"].copy()
    order[0] = -1
    with pytest.raises(DamagedScanError, match="no view"):
        Scan.load(write(tmp_path / "a.scan", stored, views_order=order))


def npy(shape, content=b"", descr="'<f8'"):
    header = f"{{'descr':{descr},'fortran_order':False,'shape':{shape}}}"
    header += " " * ((64 - (len(header) + 11) % 64) % 64) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + content


@pytest.mark.parametrize(
    "member",
    [
        npy((10**15,)),
        npy((-5,)),
        npy((2**63 - 1, 2**63 - 1)),
        npy((1,), b"cos\nsystem\n(S'false'\ntR.", "'|O'"),
        npy((1,), descr="(" * 3000 + ")" * 3000),
        npy((1,), descr="__import__('os')"),
        npy((1,), descr="(\n("),
        b"",
    ],
    ids=range(8),
)
def test_an_array_that_declares_what_it_does_not_hold_is_refused(stored, tmp_path, member):
    path = write(tmp_path / "a.scan", stored)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("store_extra.npy", member)
    with pytest.raises(DamagedScanError):
        Scan.load(path)


def test_a_compressed_archive_is_not_unpacked(stored, tmp_path):
    path = write(tmp_path / "a.scan", stored)
    with zipfile.ZipFile(path, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("bomb.npy", npy((10**8,), bytes(10**8)))
    with pytest.raises(DamagedScanError, match="compressed"):
        Scan.load(path)


@pytest.mark.parametrize("kind", ["fifo", "/dev/zero", "folder"])
def test_what_is_no_file_is_refused_and_nothing_hangs(tmp_path, kind):
    path = tmp_path / "a.scan"
    if kind == "fifo":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.symlink_to(kind)
    with pytest.raises(ScanFileError) as refused:
        Scan.load(path)
    assert not isinstance(refused.value, DamagedScanError)


def test_a_loader_keeps_to_its_own_budget(stored, tmp_path):
    path = write(tmp_path / "a.scan", stored, of_fusion(stored, memory_budget_mb=65536.0))
    loaded = Scan.load(path, SETTINGS)
    assert loaded.nbytes <= 32e6
    assert loaded.voxel_count == len(stored["store_keys"])


def test_a_scan_that_is_larger_than_the_budget_is_refused(stored, tmp_path):
    path = write(tmp_path / "a.scan", stored, volume_keys=np.arange(1, 10**5))
    with pytest.raises(MemoryBudgetError, match="memory_budget_mb = 32 MB"):
        Scan.load(path, SETTINGS)


def with_material_keys(count):
    keys = pack_key(0, 0, 0) + np.arange(count)
    header = {"next_material_id": 2}
    return {"header": header, "material_keys": keys, "material_ids": np.ones(count, np.int64)}


def test_more_materials_voxels_than_there_is_room_for_are_refused(stored, tmp_path):
    path = write(tmp_path / "a.scan", stored, **with_material_keys(60_000))
    assert len(Scan.load(path).material_ids.keys) == 60_000
    path = write(tmp_path / "a.scan", stored, **with_material_keys(200_000))
    with pytest.raises(MemoryBudgetError, match="memory_budget_mb = 32 MB"):
        Scan.load(path, SETTINGS)
    with pytest.raises(DamagedScanError, match="material_keys"):
        Scan.load(path)


def test_a_file_beyond_the_budget_is_not_even_read(stored, tmp_path, monkeypatch):
    path = write(tmp_path / "a.scan", stored, **with_material_keys(4_000_000))
    monkeypatch.setattr(zipfile, "ZipFile", None)
    with pytest.raises(MemoryBudgetError, match="memory_budget_mb = 32 MB"):
        Scan.load(path, SETTINGS)


@pytest.mark.parametrize("key", [-3, 5, 2**62])
def test_materials_of_what_is_no_voxel_are_refused(stored, tmp_path, key):
    changes = with_material_keys(1) | {"material_keys": np.array([key])}
    with pytest.raises(DamagedScanError, match="material_keys"):
        Scan.load(write(tmp_path / "a.scan", stored, **changes))


def test_a_frame_name_that_cannot_be_printed_is_saved_as_one_that_can(tmp_path):
    scan = Scan(SETTINGS, REGION)
    scan.fuse(dataclasses.replace(orbit_frames(1)[0], frame_id="cam\n\ud800", world_frame_id="é"))
    scan.save(tmp_path / "a.scan")
    loaded = Scan.load(tmp_path / "a.scan")
    assert (loaded.frame_id, loaded.world_frame_id) == ("cam??", "é")


def test_random_changes_are_refused_or_harmless(stored, tmp_path):
    whole = write(tmp_path / "whole.scan", stored).read_bytes()
    used = 0
    for seed in range(MUTATIONS):
        random = np.random.default_rng(seed)
        content = bytearray(whole)
        for place in random.integers(0, len(content), random.integers(1, 30)):
            content[place] = random.integers(0, 256)
        path = tmp_path / "changed.scan"
        path.write_bytes(content)
        try:
            scan = Scan.load(path)
        except ScanFileError:
            continue
        used += 1
        scan.fuse(orbit_frames(24)[11])
        assert np.isfinite(scan.snapshot().positions).all()
    assert used < MUTATIONS
