# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""A panorama of the room beside what the camera saw of it."""

import dataclasses

import cv2
import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.brdf.lab import luminance
from reflest_core.environment.room import Room
from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.light.equirectangular import (
    equirectangular_directions,
    equirectangular_solid_angles,
    radiance_from,
)
from reflest_core.light.known_light import KnownLightError
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_directions, octahedral_solid_angles

HEIGHT = 64


def room(directions):
    """(..., 3): bright above, redder towards +x, a lamp of 5 at the top."""
    x, y, z = np.moveaxis(directions, -1, 0)
    base = 0.2 * np.exp(0.8 * z + 0.5 * y)
    colour = np.stack([base * np.exp(0.6 * x), base, base * np.exp(-0.3 * x)], axis=-1)
    return np.where((z > 0.97)[..., None], 5.0, colour).astype(np.float32)


def panorama():
    return room(equirectangular_directions(HEIGHT))


def known_room():
    return Room.of("room", panorama()).known_light()


def seen_from_above(gain=(1.0, 1.0, 1.0)):
    """The lower half of the room, through a camera of another exposure and white balance."""
    directions = octahedral_directions(SIZE)
    is_seen = directions[..., 2] < 0.1
    radiance = np.where(is_seen[..., None], room(directions) * np.float32(gain), 0.0)
    nothing = np.zeros((SIZE, SIZE, 3), np.float32)
    return ObservedLight(radiance.astype(np.float32), is_seen.astype(np.float32), nothing)


def away_from_the_lamp():
    """Where the lamp's edge is not within a texel."""
    return np.abs(octahedral_directions(SIZE)[..., 2] - 0.97) > 0.03


def test_what_nobody_saw_comes_from_the_panorama_at_the_scans_exposure():
    gain = (0.5, 0.4, 0.7)
    joined = known_room().joined(seen_from_above(gain))
    assert joined.problem == ""
    expected = room(octahedral_directions(SIZE)) * np.float32(gain)
    clear = away_from_the_lamp()
    np.testing.assert_allclose(joined.light.radiance[clear], expected[clear], rtol=0.06)
    assert (joined.light.coverage == 1.0).all()
    assert joined.light.radiance.max() == pytest.approx(5.0 * max(gain), rel=0.05)


def test_a_small_lamp_keeps_its_power():
    """One pixel of 2.8 degrees, wherever it lies among the map's texels."""
    angles = octahedral_solid_angles(SIZE)
    pixels = equirectangular_solid_angles(HEIGHT)
    for row, column in ((10, 20), (31, 77), (32, 5), (50, 100)):
        image = np.zeros((HEIGHT, 2 * HEIGHT, 3), np.float32)
        image[row, column] = 1000.0
        power = (Room.of("lamp", image).known_light().radiance[..., 0] * angles).sum()
        assert power == pytest.approx(1000.0 * pixels[row, 0], rel=0.05)


def test_what_the_camera_saw_stays_as_it_saw_it():
    light = seen_from_above()
    is_seen = light.coverage > 0.0
    light.radiance[is_seen] *= np.random.default_rng(0).uniform(0.9, 1.1, (is_seen.sum(), 1))
    joined = known_room().joined(light)
    np.testing.assert_array_equal(joined.light.radiance[is_seen], light.radiance[is_seen])


def test_a_lower_bound_becomes_a_value():
    light = seen_from_above()
    directions = octahedral_directions(SIZE)
    light.coverage[:] = 1.0
    light.radiance[:] = np.minimum(room(directions), 1.0)
    clipped = (room(directions) > 1.0).astype(np.float32)
    light = dataclasses.replace(light, clipped=clipped)
    joined = known_room().joined(light).light
    assert not joined.clipped.any()
    lamp = directions[..., 2] > 0.99
    np.testing.assert_allclose(joined.radiance[lamp], 5.0, rtol=0.05)


def test_another_room_is_left_out():
    other = np.exp(np.random.default_rng(1).normal(0.0, 2.0, (HEIGHT, 2 * HEIGHT, 3)))
    light = seen_from_above()
    joined = Room.of("other", other.astype(np.float32)).known_light().joined(light)
    assert "another place" in joined.problem
    assert joined.light is light


def test_too_little_in_common_is_said():
    light = seen_from_above()
    light.coverage[:] = 0.0
    joined = known_room().joined(light)
    assert "shares 0 directions" in joined.problem
    assert joined.light is light


def test_a_panorama_comes_back_from_a_file(tmp_path):
    cv2.imwrite(str(tmp_path / "room.hdr"), panorama()[..., ::-1])
    known = Room.read(tmp_path / "room.hdr").known_light()
    clear = away_from_the_lamp()
    truth = room(octahedral_directions(SIZE))[clear]
    np.testing.assert_allclose(known.radiance[clear], truth, rtol=0.06)
    assert known.is_known.all()


def test_an_earlier_scan_knows_what_it_saw(tmp_path):
    scan = Scan(FusionSettings(), RegionSettings())
    directions = octahedral_directions(SIZE).reshape(-1, 3)
    above = directions[directions[:, 2] > 0.0]
    colours = np.uint8(np.rint(255 * srgb.encode(np.minimum(room(above), 1.0))))
    scan.light.add(above, colours)
    scan.save(tmp_path / "earlier")
    known = Room.read(tmp_path / "earlier").known_light()
    is_lamp = room(octahedral_directions(SIZE)).max(axis=-1) >= 1.0
    is_seen = (octahedral_directions(SIZE)[..., 2] > 0.0) & ~is_lamp
    np.testing.assert_array_equal(known.is_known, is_seen)
    truth = room(octahedral_directions(SIZE))[is_seen]
    np.testing.assert_allclose(known.radiance[is_seen], truth, rtol=0.1)


@pytest.mark.parametrize(
    ("image", "reason"),
    [
        (np.ones((32, 32, 3), np.float32), "32 x 32 pixels"),
        (np.zeros((32, 64, 3), np.float32), "black"),
        (None, "cannot be read"),
    ],
)
def test_a_file_that_is_of_no_use_is_refused_by_name(tmp_path, image, reason):
    path = tmp_path / "room.hdr"
    if image is None:
        path.write_bytes(b"not an image")
    else:
        cv2.imwrite(str(path), image)
    with pytest.raises(KnownLightError, match=rf"estimation\.known_light = .*room\.hdr .*{reason}"):
        Room.read(path)


def test_a_file_that_is_no_scan_is_refused_by_name(tmp_path):
    (tmp_path / "notes.txt").write_text("the lamp is on the left")
    with pytest.raises(KnownLightError, match=r"neither an .* panorama nor a scan: .*notes\.txt"):
        Room.read(tmp_path / "notes.txt")


def test_lookup_and_directions_agree():
    directions = octahedral_directions(24).reshape(-1, 3)
    found = radiance_from(panorama(), directions)
    clear = directions[:, 2] < 0.9
    truth = luminance(room(directions))[clear]
    np.testing.assert_allclose(luminance(found)[clear], truth, rtol=0.03)
