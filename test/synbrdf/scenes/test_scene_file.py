# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is on disk stays readable: the format of far light byte for byte, that of rooms whole."""

import dataclasses
import hashlib

import numpy as np
import pytest

from reflest_core.brdf.parameters import WardParameters
from reflest_core.surface.observed_surface import ObservedSurface
from reflest_core.synbrdf.scenes.scene_file import (
    SceneFileError,
    SynbrdfScene,
    load_shard,
    shard_bytes,
)
from reflest_core.synbrdf.scenes.scene_materials import SceneMaterial, VoxelMaterials
from reflest_core.synbrdf.scenes.thumbnails import Thumbnails
from reflest_core.whole_file import write_whole


def far_scene():
    """Numbers that every machine holds alike."""
    counting = np.arange(24)
    surface = ObservedSurface(
        positions=(counting[:6].reshape(2, 3) / 8).astype(np.float32),
        normals=np.eye(3, dtype=np.float32)[:2],
        offsets=np.array([0, 2, 3]),
        colours=counting[:9].reshape(3, 3).astype(np.uint8),
        view_indices=np.array([0, 1, 1], np.uint16),
        view_centres=np.eye(3, dtype=np.float32)[1:],
        view_foreground=np.full((2, 3), 7.5, np.float32),
        view_background=np.full((2, 3), 130.25, np.float32),
    )
    thumbnails = Thumbnails(
        rgbe=np.resize(counting, (2, 36, 48, 4)).astype(np.uint8),
        is_object=np.resize(counting % 5 == 0, (2, 36, 48)),
        T_world_camera=np.tile(np.eye(4, dtype=np.float32), (2, 1, 1)),
    )
    return SynbrdfScene(
        surface=surface,
        materials=VoxelMaterials.uniform(
            SceneMaterial(WardParameters((0.5, 0.25, 0.125), 0.0625, 0.25)),
            surface.voxel_count,
        ),
        split="train",
        index=4,
        environment="sunny+dim",
        environment_rotation=0.5,
        shape="blob",
        view_pattern="orbit",
        exposure=2.0,
        radiance=(counting[:9].reshape(3, 3) / 16).astype(np.float16),
        thumbnails=thumbnails,
    )


def near_scene():
    scene = far_scene()
    depth = np.resize(np.arange(3000, dtype=np.uint16), (2, 36, 48))
    return dataclasses.replace(scene, thumbnails=dataclasses.replace(scene.thumbnails, depth=depth))


def test_far_scenes_keep_the_bytes_that_sets_already_have():
    """The hash is of the code before there was depth: no set on any disk may become unreadable."""
    digest = hashlib.sha256(shard_bytes([far_scene()])).hexdigest()
    assert digest == "b02835906f6386b454303d0130841a31b2979c6992c6ebfa432efc226c4b86e3"


@pytest.mark.parametrize("make", [far_scene, near_scene])
def test_a_scene_comes_back_as_it_was(make, tmp_path):
    scene = make()
    (tmp_path / "train-00000.safetensors").write_bytes(shard_bytes([scene, scene]))
    for loaded in load_shard(tmp_path / "train-00000.safetensors"):
        for part in ("surface", "thumbnails"):
            for name, array in vars(getattr(scene, part)).items():
                np.testing.assert_array_equal(getattr(getattr(loaded, part), name), array)
        assert loaded.materials.materials == scene.materials.materials
        assert loaded.environment == scene.environment
        assert (loaded.thumbnails.depth is None) == (scene.thumbnails.depth is None)


def test_rooms_have_a_format_of_their_own(tmp_path):
    """So that code which knows no depth refuses them, and does not take walls for far light."""
    assert b"synbrdf-sparse-2" in shard_bytes([far_scene()])
    near = shard_bytes([near_scene()])
    assert b"synbrdf-sparse-3" in near
    write_whole(tmp_path / "x.safetensors", near.replace(b"sparse-3", b"sparse-9"))
    with pytest.raises(SceneFileError, match="synbrdf-sparse-3"):
        load_shard(tmp_path / "x.safetensors")
