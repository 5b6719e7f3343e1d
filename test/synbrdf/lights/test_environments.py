# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
import importlib

import cv2
import numpy as np
import pytest

from reflest_core.errors import ReflestError
from reflest_core.light.equirectangular import equirectangular_directions, radiance_from
from reflest_core.synbrdf.lights.environments import (
    EnvironmentUnreadable,
    find_environments,
    load_environment,
    procedural_skies,
    resample,
    rotated,
)
from reflest_core.synbrdf.lights.procedural_sky import procedural_sky


def gradient(height=16):
    rows, columns = np.mgrid[:height, : 2 * height]
    return np.stack([rows + 1.0, columns + 1.0, rows + columns], -1).astype(np.float32)


def test_directions_follow_the_convention():
    towards = equirectangular_directions(64)
    np.testing.assert_allclose(np.linalg.norm(towards, axis=-1), 1.0)
    assert towards[0, :, 2].min() > 0.99
    assert towards[-1, :, 2].max() < -0.99
    np.testing.assert_allclose(towards[32, 64], [1, 0, 0], atol=0.05)
    np.testing.assert_allclose(towards[32, 32], [0, 1, 0], atol=0.05)
    np.testing.assert_allclose(towards[32, 96], [0, -1, 0], atol=0.05)


def test_lookup_returns_the_texel_and_means_between_them():
    environment = gradient()
    towards = equirectangular_directions(16)
    seen = radiance_from(environment, towards.reshape(-1, 3).astype(np.float32))
    np.testing.assert_allclose(seen, environment.reshape(-1, 3), atol=1e-3)
    polar = (5 + 0.5) / 16 * np.pi
    azimuth = (0.5 - 8 / 32) * 2 * np.pi  # on the border between columns 7 and 8
    between = np.array(
        [[np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)]],
        np.float32,
    )
    expected = (environment[5, 7] + environment[5, 8]) / 2
    np.testing.assert_allclose(radiance_from(environment, between)[0], expected, atol=1e-3)


def test_lookup_has_no_seam_behind():
    environment = gradient()
    behind = np.array([[-1.0, 1e-7, 0.0], [-1.0, -1e-7, 0.0]], np.float32)
    one, other = radiance_from(environment, behind)
    np.testing.assert_allclose(one, other, atol=1e-3)
    np.testing.assert_allclose(one[1], (1 + 32) / 2, atol=1e-3)


def test_rotation_turns_anticlockwise():
    environment = np.zeros((16, 32, 3), np.float32)
    environment[8, 16] = 5.0  # about +x
    turned = rotated(environment, np.pi / 2)
    row, column = np.unravel_index(turned[..., 0].argmax(), (16, 32))
    np.testing.assert_allclose(equirectangular_directions(16)[row, column], [0, 1, 0], atol=0.15)
    np.testing.assert_allclose(turned.sum(), environment.sum(), rtol=1e-5)


def test_reads_hdr_exr_and_collections(tmp_path):
    image = gradient()
    np.savez(tmp_path / "set.npz", dawn=image, dusk=2 * image)
    cv2.imwrite(str(tmp_path / "noon.hdr"), image[..., ::-1])
    found = {source.name: source for source in find_environments(tmp_path)}
    assert list(found) == ["dawn", "dusk", "noon"]
    np.testing.assert_array_equal(load_environment(found["dusk"], 16), 2 * image)
    np.testing.assert_allclose(load_environment(found["noon"], 16), image, rtol=0.02, atol=0.2)


def test_negative_texels_become_black(tmp_path):
    image = gradient()
    image[3, 4] = -2.0
    np.savez(tmp_path / "set.npz", odd=image)
    loaded = load_environment(find_environments(tmp_path)[0], 16)
    assert loaded[3, 4].tolist() == [0, 0, 0]
    assert loaded[3, 5].tolist() == image[3, 5].tolist()


def test_shrinking_keeps_the_light():
    image = np.zeros((64, 128, 3), np.float32)
    image[10, 20] = 1000.0
    assert resample(image, 16).mean() == pytest.approx(image.mean(), rel=1e-4)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (np.full((16, 32, 3), np.nan, np.float32), "not below"),
        (np.full((16, 32, 3), 1e38, np.float32), "not below"),
        (np.zeros((16, 32, 3), np.float32), "black"),
        (np.ones((16, 32), np.float32), "shape"),
    ],
)
def test_unusable_light_is_refused_by_name(tmp_path, content, reason):
    np.savez(tmp_path / "set.npz", crooked=content)
    with pytest.raises(EnvironmentUnreadable, match=f"crooked.*{reason}"):
        load_environment(find_environments(tmp_path)[0], 16)


def test_damaged_and_missing_files_are_refused_in_one_sentence(tmp_path):
    (tmp_path / "broken.hdr").write_bytes(b"#?RADIANCE\nnonsense")
    with pytest.raises(ReflestError, match="broken"):
        load_environment(find_environments(tmp_path)[0], 16)
    (tmp_path / "broken.npz").write_bytes(b"PK nonsense")
    with pytest.raises(ReflestError, match=r"broken\.npz"):
        find_environments(tmp_path)
    with pytest.raises(ReflestError, match="no environment file or folder"):
        find_environments(tmp_path / "absent")
    (tmp_path / "empty").mkdir()
    with pytest.raises(ReflestError, match="holds no environment"):
        find_environments(tmp_path / "empty")


def test_skies_need_no_file_and_differ():
    sources = procedural_skies(4)
    skies = [load_environment(source, 32) for source in sources]
    assert all(sky.shape == (32, 64, 3) and sky.min() >= 0 for sky in skies)
    assert all(np.isfinite(sky).all() for sky in skies)
    assert len({sky.tobytes() for sky in skies}) == 4
    np.testing.assert_array_equal(procedural_sky(2, 32), skies[2])
    # A sun: something far brighter than the rest, above the horizon.
    for sky in skies:
        row = np.unravel_index(sky.sum(-1).argmax(), (32, 64))[0]
        assert row < 16
        assert sky.max() > 20 * np.median(sky)


def test_scripts_of_users_find_environments_by_their_first_name():
    by_name = importlib.import_module("reflest_core.synbrdf.environments")
    assert by_name.find_environments is find_environments
    assert by_name.load_environment is load_environment
