# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Cube maps: known bit patterns, the right face in every direction, and files that are refused."""

import struct

import numpy as np
import pytest

from reflest_core.light.equirectangular import equirectangular_directions
from reflest_core.synbrdf.lights.cubemap import IDENTIFIER, look_up, read_cubemap
from reflest_core.synbrdf.lights.environments import (
    EnvironmentUnreadable,
    find_environments,
    load_environment,
)

FACES = {"+x": 0, "-x": 1, "up": 2, "down": 3, "+z": 4, "-z": 5}


def ktx(pixels, internal=0x8C3A, faces=6):
    size = pixels.shape[1]
    header = struct.pack(
        "<13I", 0x04030201, 0x8C3A, 4, 0x1907, internal, 0x1907, size, size, 0, 0, faces, 1, 0
    )
    return IDENTIFIER + header + struct.pack("<I", 4 * size * size) + pixels.astype("<u4").tobytes()


def test_floats_of_eleven_and_ten_bits(tmp_path):
    """1.0 is exponent 15; 1.5 adds half the mantissa; the least denormal is 2 to the -14 - 6."""
    one, one_and_half, least = 15 << 6, (15 << 6) | 32, 1
    blue_two = 16 << 5
    pixel = np.array([one | one_and_half << 11 | blue_two << 22, least])
    pixels = np.resize(pixel, (6, 2, 2))
    path = tmp_path / "some.ktx"
    path.write_bytes(ktx(pixels))
    faces = read_cubemap(path)
    np.testing.assert_array_equal(faces[0, 0, 0], [1.0, 1.5, 2.0])
    np.testing.assert_allclose(faces[0, 0, 1], [2.0**-20, 0.0, 0.0])


def test_every_direction_finds_its_face():
    faces = np.arange(6, dtype=np.float32)[:, None, None, None] * np.ones((6, 4, 4, 3), np.float32)
    along = np.array([[1, 0, 0], [-1, 0, 0], [0, 0, 1], [0, 0, -1], [0, -1, 0], [0, 1, 0.0]])
    assert look_up(faces, along)[:, 0].tolist() == [0, 1, 2, 3, 4, 5]


def test_neighbouring_faces_meet_without_a_seam():
    """A cube drawn from a smooth function of direction gives that function back."""
    size = 64
    centre = (np.arange(size) + 0.5) / size * 2 - 1
    across, down = np.meshgrid(centre, centre)
    one = np.ones_like(across)
    cube = [
        (one, -down, -across),
        (-one, -down, across),
        (across, one, down),
        (across, -one, -down),
        (across, -down, one),
        (-across, -down, -one),
    ]
    faces = np.stack([np.stack(face, axis=-1) for face in cube])
    faces /= np.linalg.norm(faces, axis=-1, keepdims=True)
    wanted = equirectangular_directions(40)
    found = look_up(faces.astype(np.float32), wanted)
    back = np.stack([found[..., 0], -found[..., 2], found[..., 1]], axis=-1)
    assert np.abs(back - wanted).max() < 2.5 / size


def test_a_folder_of_cube_maps_is_a_folder_of_environments(tmp_path):
    (tmp_path / "grey.ktx").write_bytes(ktx(np.full((6, 8, 8), 15 << 6 | 15 << 17 | 15 << 27)))
    source = find_environments(tmp_path)[0]
    assert source.name == "grey"
    np.testing.assert_allclose(load_environment(source, 32), 1.0, rtol=1e-6)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"no",
        ktx(np.zeros((6, 8, 8)))[:-1],
        ktx(np.zeros((6, 8, 8)), internal=0x8058),
        ktx(np.zeros((1, 8, 8)), faces=1),
    ],
)
def test_other_files_are_refused_by_name(tmp_path, data):
    (tmp_path / "bad.ktx").write_bytes(data)
    with pytest.raises(EnvironmentUnreadable, match="bad"):
        load_environment(find_environments(tmp_path)[0])
