# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""The room that a camera is in is told among others, however it is turned."""

import dataclasses

import cv2
import numpy as np
import OpenEXR
import pytest

from reflest_core.environment.known_rooms import KnownRooms, read_known_light
from reflest_core.environment.room import Room
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.light import rgbe
from reflest_core.light.equirectangular import equirectangular_directions
from reflest_core.light.known_light import KnownLight, KnownLightError
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_directions
from reflest_core.surface.upright import rotation_about_z

HEIGHT = 64
SEEDS = range(6)


def turned(directions, angle):
    return np.float32(directions @ rotation_about_z(angle).T)


def brightness(seed, directions):
    """(..., 3): smooth waves of a room's own, brighter above, of every hue."""
    rng = np.random.default_rng(seed)
    waves = 2.0 * rng.normal(size=(3, 12, 3)), rng.uniform(0.0, 6.3, (3, 12))
    phases = np.einsum("...k,cwk->...cw", directions, waves[0]) + waves[1]
    logs = 0.25 * np.sin(phases).sum(axis=-1) + 0.4 * directions[..., 2:]
    return np.asarray(0.15 * np.exp(logs), np.float32)


def room(seed):
    return Room.of(f"room-{seed}", brightness(seed, equirectangular_directions(HEIGHT)))


def rooms(seeds=SEEDS):
    return KnownRooms([room(seed) for seed in seeds], "rooms")


def seen(seed, turn, gain=(1.0, 1.0, 1.0), highest=0.1):
    """What a camera that looks down sees of the room, turned counterclockwise from above."""
    directions = octahedral_directions(SIZE)
    is_seen = directions[..., 2] < highest
    of_room = turned(directions.reshape(-1, 3), -turn).reshape(SIZE, SIZE, 3)
    radiance = np.minimum(brightness(seed, of_room) * np.float32(gain), 1.0)
    clipped = (radiance == 1.0).astype(np.float32) * is_seen[..., None]
    radiance = np.where(is_seen[..., None], radiance, np.float32(0.0))
    return ObservedLight(radiance, is_seen.astype(np.float32), clipped)


@pytest.mark.parametrize(("seed", "turn"), [(0, 0.0), (2, 0.4), (5, 3.3), (3, 6.2)])
def test_the_room_is_recognised_at_any_turn_and_exposure(seed, turn):
    gain = (0.5, 0.6, 0.4)
    joined = rooms().joined(seen(seed, turn, gain))
    assert joined.problem == ""
    directions = octahedral_directions(SIZE).reshape(-1, 3)
    truth = brightness(seed, turned(directions, -turn)) * np.float32(gain)
    found = joined.light.radiance.reshape(-1, 3)
    assert np.median(np.abs(found / truth - 1.0)) < 0.02
    assert np.quantile(np.abs(found / truth - 1.0), 0.99) < 0.1
    assert joined.light.coverage.all()


def test_a_room_that_is_not_among_them_is_not_taken_for_another():
    light = seen(17, 0.4)
    joined = rooms().joined(light)
    assert joined.light is light
    assert "none of the 6 rooms" in joined.problem
    assert "room-" in joined.problem


def test_two_rooms_that_look_alike_are_not_distinguished():
    alike = KnownRooms([room(0), dataclasses.replace(room(0), name="twin")], "rooms")
    light = seen(0, 0.4)
    assert alike.joined(light).light is light


def test_too_little_seen_is_said():
    light = seen(0, 0.4, highest=-1.0)
    joined = rooms().joined(light)
    assert joined.light is light
    assert "too little of the surroundings was seen" in joined.problem


def test_only_what_is_known_of_a_room_is_taken():
    """An earlier scan saw the half towards +x alone."""
    whole = room(1)
    is_known = equirectangular_directions(HEIGHT)[..., 0] > 0.0
    radiance = whole.radiance * is_known[..., None]
    half = dataclasses.replace(whole, radiance=radiance, is_known=is_known)
    among = KnownRooms([half, *(room(seed) for seed in (2, 3, 4))], "rooms")
    joined = among.joined(seen(1, 0.7))
    assert joined.problem == ""
    of_room = turned(octahedral_directions(SIZE).reshape(-1, 3), -0.7)
    is_above = (octahedral_directions(SIZE)[..., 2] > 0.15).reshape(-1)
    covered = joined.light.coverage.reshape(-1) > 0.0
    is_clear = np.abs(of_room[:, 0]) > 0.05
    np.testing.assert_array_equal(
        covered[is_above & is_clear], (of_room[:, 0] > 0.0)[is_above & is_clear]
    )
    truth = brightness(1, of_room)
    taken = is_above & is_clear & covered
    np.testing.assert_allclose(joined.light.radiance.reshape(-1, 3)[taken], truth[taken], rtol=0.15)


def test_a_room_of_which_nothing_in_sight_is_known_is_not_recognised():
    whole = room(1)
    is_known = equirectangular_directions(HEIGHT)[..., 2] > 0.3
    above = dataclasses.replace(whole, is_known=is_known)
    light = seen(1, 0.7)
    joined = KnownRooms([above], "rooms").joined(light)
    assert joined.light is light
    assert "none of the 1 rooms" in joined.problem


def test_a_folder_holds_panoramas_and_scans(tmp_path):
    cv2.imwrite(str(tmp_path / "kitchen.hdr"), room(0).radiance[..., ::-1])
    scan = Scan(FusionSettings(), RegionSettings())
    scan.light.add(
        octahedral_directions(SIZE).reshape(-1, 3), np.full((SIZE * SIZE, 3), 90, np.uint8)
    )
    scan.save(tmp_path / "hall")
    found = read_known_light(tmp_path)
    assert isinstance(found, KnownRooms)
    assert [one.name for one in found.rooms] == ["hall", "kitchen"]
    assert found.rooms[0].is_known.all()


def test_a_file_is_one_room_in_the_worlds_axes(tmp_path):
    cv2.imwrite(str(tmp_path / "kitchen.hdr"), room(0).radiance[..., ::-1])
    assert isinstance(read_known_light(tmp_path / "kitchen.hdr"), KnownLight)


@pytest.mark.parametrize(("content", "reason"), [(None, "is empty"), ("a note", "notes")])
def test_a_folder_of_no_use_is_refused_by_name(tmp_path, content, reason):
    if content:
        (tmp_path / "notes").write_text(content)
    with pytest.raises(KnownLightError, match=rf"estimation\.known_light.*{reason}"):
        read_known_light(tmp_path)


def test_light_too_bright_for_sums_is_refused(tmp_path):
    header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n"
    (tmp_path / "sun.hdr").write_bytes(header + b"\xff" * (64 * 128 * 4))
    with pytest.raises(KnownLightError, match="radiance that is not below"):
        read_known_light(tmp_path / "sun.hdr")


def test_an_exr_panoramas_alpha_says_what_is_known(tmp_path):
    radiance = brightness(1, equirectangular_directions(HEIGHT))
    alpha = np.ones((HEIGHT, 2 * HEIGHT, 1), np.float32)
    alpha[:, :HEIGHT] = 0.0
    pixels = {"RGBA": np.concatenate([radiance, alpha], axis=-1)}
    OpenEXR.File({"type": OpenEXR.scanlineimage}, pixels).write(str(tmp_path / "room.exr"))
    known = read_known_light(tmp_path / "room.exr")
    is_right = octahedral_directions(SIZE)[..., 1] < -0.05  # the image's right half
    is_left = octahedral_directions(SIZE)[..., 1] > 0.05
    assert known.is_known[is_right].all()
    assert not known.is_known[is_left].any()
    assert known.warning == ""


def test_an_exr_that_knows_nothing_is_refused(tmp_path):
    pixels = {"RGBA": np.zeros((8, 16, 4), np.float32)}
    OpenEXR.File({"type": OpenEXR.scanlineimage}, pixels).write(str(tmp_path / "room.exr"))
    with pytest.raises(KnownLightError, match="no pixel with alpha"):
        read_known_light(tmp_path / "room.exr")


def test_an_hdr_of_our_own_is_used_with_a_warning(tmp_path):
    radiance = brightness(1, equirectangular_directions(HEIGHT))
    path = tmp_path / "light.hdr"
    path.write_bytes(
        b"#?RADIANCE\nSOFTWARE=reflest\nFORMAT=32-bit_rle_rgbe\n\n"
        + f"-Y {HEIGHT} +X {2 * HEIGHT}\n".encode()
        + rgbe.encode(radiance).tobytes()
    )
    known = read_known_light(path)
    assert known.is_known.all()
    joined = known.joined(seen(1, 0.0))
    assert joined.light.coverage.all()
    assert "export it as .exr" in joined.problem
