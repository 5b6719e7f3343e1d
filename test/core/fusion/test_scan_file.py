# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import json

import numpy as np
import pytest

from reflest_core.errors import ReflestError
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.scan_file import ScanFileError
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.light.light_map import SIZE
from reflest_core.surface.material_ids import GivenIds
from reflest_core.surface.voxel_key import pack_key
from reflest_core.whole_file import OutputError
from test.core.fusion.analytic_scene import orbit_frames
from test.core.fusion.scan_state import assert_same_arrays, assert_same_surface, state_of

SETTINGS = FusionSettings(max_depth=1.0, observations_per_voxel=6)
REGION = RegionSettings("sphere", (0.0, 0.0, 0.01), (0.3, 0.3, 0.3))


@pytest.fixture
def scan():
    scan = Scan(SETTINGS, REGION)
    for frame in orbit_frames(24)[:10]:
        scan.fuse(frame)
    return scan


@pytest.fixture
def saved(scan, tmp_path):
    path = tmp_path / "cup.scan"
    scan.save(path)
    return path


def rewrite(path, **changes):
    """Replace arrays of a saved file; a dict given as ``header`` changes the header's entries."""
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    header = json.loads(str(arrays["header"])) | changes.pop("header", {})
    arrays = arrays | changes | {"header": np.array(json.dumps(header))}
    with path.open("wb") as file:
        np.savez(file, **{name: array for name, array in arrays.items() if array is not None})


def test_loaded_scan_is_the_saved_one_and_goes_on_as_it_would(scan, saved):
    loaded = Scan.load(saved)
    assert (loaded.fusion, loaded.region_settings) == (SETTINGS, REGION)
    assert_same_arrays(state_of(scan), state_of(loaded))
    assert_same_surface(scan.snapshot(), loaded.snapshot())
    for frame in orbit_frames(24)[10:]:
        assert repr(scan.fuse(frame)) == repr(loaded.fuse(frame))
    assert_same_arrays(state_of(scan), state_of(loaded))


def test_empty_scan_round_trips(tmp_path):
    Scan(SETTINGS, REGION).save(tmp_path / "empty.scan")
    loaded = Scan.load(tmp_path / "empty.scan")
    assert loaded.voxel_count == 0
    assert loaded.fuse(orbit_frames(1)[0]).is_new_view


KEYS = pack_key(0, 0, 0) + np.array([3, 7, 9])


def test_material_ids_are_kept(scan, tmp_path):
    scan.material_ids = GivenIds(KEYS, np.array([2, 5, 2]), 6)
    scan.save(tmp_path / "ids.scan")
    loaded = Scan.load(tmp_path / "ids.scan").material_ids
    np.testing.assert_array_equal(loaded.keys, KEYS)
    np.testing.assert_array_equal(loaded.ids, [2, 5, 2])
    assert loaded.next_id == 6


def test_a_file_from_before_material_ids_has_none(saved):
    rewrite(saved, material_keys=None, material_ids=None)
    assert len(Scan.load(saved).material_ids.keys) == 0


@pytest.mark.parametrize(
    "changes",
    [
        {"material_ids": None},
        {"material_ids": np.array([1, 2])},
        {"material_keys": KEYS[[0, 0, 2]]},
        {"material_keys": KEYS.astype(np.float64)},
        {"material_ids": np.array([1, 2, 6])},
        {"material_ids": np.array([0, 2, 3])},
        {"header": {"next_material_id": 2**40}},
        {"header": {"next_material_id": "6"}},
    ],
)
def test_material_ids_that_cannot_be_right_are_refused(scan, tmp_path, changes):
    path = tmp_path / "ids.scan"
    scan.material_ids = GivenIds(KEYS, np.array([2, 5, 2]), 6)
    scan.save(path)
    rewrite(path, **changes)
    with pytest.raises(ScanFileError, match="damaged"):
        Scan.load(path)


def test_saving_replaces_and_leaves_nothing_else(scan, saved):
    scan.save(saved)
    assert [p.name for p in saved.parent.iterdir()] == [saved.name]


def test_missing_file(tmp_path):
    with pytest.raises(ScanFileError, match="there is no scan file"):
        Scan.load(tmp_path / "none.scan")


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.999])
def test_truncated_file(saved, share):
    whole = saved.read_bytes()
    saved.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ScanFileError, match=r"cup\.scan"):
        Scan.load(saved)


def test_flipped_byte(saved):
    whole = bytearray(saved.read_bytes())
    whole[len(whole) // 2] ^= 0xFF
    saved.write_bytes(whole)
    with pytest.raises(ScanFileError, match="damaged"):
        Scan.load(saved)


def test_other_files(tmp_path):
    text = tmp_path / "notes.txt"
    text.write_text("not a scan")
    with pytest.raises(ScanFileError, match="not a scan"):
        Scan.load(text)
    np.savez(tmp_path / "weights.npz", weights=np.ones(3))
    with pytest.raises(ScanFileError, match="not a scan"):
        Scan.load(tmp_path / "weights.npz")
    with pytest.raises(ScanFileError):
        Scan.load(tmp_path)


def test_pickle_is_not_opened(saved):
    rewrite(saved, store_keys=np.array([{"a": 1}], object))
    with pytest.raises(ScanFileError):
        Scan.load(saved)


def test_other_version_is_named(saved):
    rewrite(saved, header={"version": 99})
    with pytest.raises(ScanFileError, match="version 99"):
        Scan.load(saved)


@pytest.mark.parametrize("without_light", [False, True])
def test_a_file_of_version_2_is_read(scan, saved, without_light):
    """It knew neither exposures nor, in its first days, the light."""
    gone = {"light_white": None, "views_gains": None}
    if without_light:
        gone |= {f"light_{name}": None for name in scan.light.arrays}
    else:
        gone["light_clipped_count"] = scan.light.clipped_count.max(axis=-1)
    rewrite(saved, header={"version": 2, "exposure_gain": None}, **gone)
    loaded = Scan.load(saved)
    same = {
        name
        for name in state_of(scan)
        if name != "light.clipped_count" and not (without_light and name.startswith("light."))
    }
    before, after = state_of(scan), state_of(loaded)
    assert_same_arrays({name: before[name] for name in same}, {name: after[name] for name in same})
    assert (loaded.snapshot().light.seen_share > 0.0) != without_light
    assert loaded.fuse(orbit_frames(24)[10]).view is not None


def test_a_file_of_version_3_is_read(scan, saved):
    """It held clipped light, but not by channel."""
    of_any = np.arange(SIZE * SIZE, dtype=np.float32).reshape(SIZE, SIZE)
    rewrite(saved, header={"version": 3}, light_clipped_count=of_any)
    loaded = Scan.load(saved)
    for channel in range(3):
        np.testing.assert_array_equal(loaded.light.clipped_count[..., channel], of_any)


@pytest.mark.parametrize(
    "changes",
    [
        {"store_counts": None},
        {"store_keys": np.zeros(3, np.int64)},
        {"volume_tsdf": np.zeros((2, 8, 8, 8), np.float64)},
        {"views_stamps": np.zeros(9, np.int64)},
        {"header": {"frame_number": "many"}},
        {"header": {"fusion": {"voxels": 3}}},
    ],
)
def test_contents_that_do_not_fit(saved, changes):
    rewrite(saved, **changes)
    with pytest.raises(ScanFileError, match="damaged"):
        Scan.load(saved)


def test_observation_of_a_view_that_is_not_there(saved):
    with np.load(saved) as file:
        view_ids, first = file["chunks_view_ids"], file["store_first_chunks"]
    view_ids[first[0], 0] = 4000
    rewrite(saved, chunks_view_ids=view_ids)
    with pytest.raises(ScanFileError, match="damaged"):
        Scan.load(saved)


@pytest.mark.parametrize("chunk", [-7, -1, 0, 10**6])
def test_broken_chain_of_observations(saved, chunk):
    with np.load(saved) as file:
        first = file["store_first_chunks"]
    first[1:3] = chunk
    rewrite(saved, store_first_chunks=first)
    with pytest.raises(ScanFileError, match="damaged"):
        Scan.load(saved)


def test_setting_out_of_range_is_one_sentence(saved):
    fusion = {"voxel_size": 77.0}
    rewrite(saved, header={"fusion": fusion})
    with pytest.raises(ReflestError, match="voxel_size"):
        Scan.load(saved)


def test_failed_save_leaves_the_file_as_it_was(scan, saved, monkeypatch):
    before = saved.read_bytes()

    def full(*_args, **_kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OutputError, match="No space left"):
        scan.save(saved)
    assert saved.read_bytes() == before
    assert [p.name for p in saved.parent.iterdir()] == [saved.name]


def test_folder_that_is_not_there(scan, tmp_path):
    with pytest.raises(OutputError, match="cannot write"):
        scan.save(tmp_path / "none" / "cup.scan")
