# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Features of a whole minibatch are those that the live path builds for each surface."""

import dataclasses

import numpy as np
import pytest
import torch

from reflest_core.models.grouplet.batched_grouplets import batched_grouplets, choose_observations
from reflest_core.models.grouplet.grouplets import DRAWN_FROM, draw_grouplets
from reflest_core.models.hemicnn import batched_hemispheres as hemispheres
from reflest_core.models.hemicnn.hemisphere_images import hemisphere_images
from reflest_core.models.minibatch import PackedScenes
from reflest_core.models.recipe import Augmentation
from reflest_core.surface.selection import keep_views
from reflest_core.surface.tangent_frame import tangent_frame
from reflest_core.surface.voxel_choice import choose_voxels
from reflest_core.training.surface import spread_voxels as spread
from reflest_core.training.surface.drawn_scenes import SceneDrawer
from reflest_core.training.surface.spread_voxels import random_voxels, spread_voxels
from test.core.surfaces import sphere_surface

# The second has voxels with fewer than five observations.
SURFACES = [sphere_surface(300, 30, 0), sphere_surface(200, 9, 1), sphere_surface(30, 25, 2)]
PACKED = PackedScenes.of(SURFACES, np.full((3, 5), 0.1))
EVERYTHING = Augmentation(views=(1000, 1000), candidates=1000, channel_swap=False)


def seeded(seed):
    return torch.Generator().manual_seed(seed)


def drawn(voxels=20, batch_size=8):
    scenes = SceneDrawer(PACKED, EVERYTHING).draw(batch_size, voxels, seeded(0))
    unturned = torch.eye(3).expand(batch_size, 3, 3)
    return dataclasses.replace(scenes, rotation=unturned)


def each_scene(scenes):
    """Number in the batch, surface and its voxels."""
    for b, scene in enumerate(scenes.scenes.tolist()):
        yield b, SURFACES[scene], (scenes.voxels[b] - PACKED.first_voxel[scene]).numpy()


def test_grouplets_are_those_of_the_live_path():
    # Beyond that many, the live path's nodes share observations to save time; each alone is alike.
    assert max(surface.observation_counts.max() for surface in SURFACES) <= DRAWN_FROM
    scenes, nodes = drawn(), 10
    uniform = np.random.default_rng(3).random((20 * nodes, 5))
    given = torch.from_numpy(uniform).view(1, 20, nodes, 5).expand(8, -1, -1, -1)
    branches, normals = batched_grouplets(PACKED, scenes, given)
    for b, surface, voxels in each_scene(scenes):
        expected = draw_grouplets(surface, voxels, seed=3)
        np.testing.assert_allclose(branches[b].numpy(), expected.branches, atol=2e-6)
        np.testing.assert_array_equal(normals[b].numpy(), expected.normals)


@pytest.mark.parametrize("images", [hemispheres._by_kernel, hemispheres._by_tensors])
def test_hemisphere_images_are_those_of_the_live_path(images):
    scenes = drawn()
    azimuths = torch.linspace(-0.5, 0.5, 8)
    batched = images(PACKED, scenes, azimuths).numpy()
    for b, surface, voxels in each_scene(scenes):
        expected = hemisphere_images(surface, voxels, np.full(20, float(azimuths[b])))
        # A few pixels lie equally far from two observations, where rounding decides.
        assert (batched[b] == expected).mean() > 0.995


def test_a_voxel_that_nothing_saw_is_black():
    scenes = drawn()
    seen = scenes.seen.clone()
    seen[0, 3] = False
    blind = dataclasses.replace(scenes, seen=seen)
    images = hemispheres._by_tensors(PACKED, blind, torch.zeros(8))
    assert images[0, 3].abs().max() == 0
    assert images[0, 2].abs().max() > 0
    branches, _ = batched_grouplets(PACKED, blind, torch.rand(8, 20, 2, 5, generator=seeded(4)))
    assert branches[0, 6:8].abs().max() == 0
    assert branches[0, 5].abs().max() > 0


def test_tangent_frames_are_those_of_the_live_path():
    normals = np.random.default_rng(0).normal(size=(50, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.concatenate([normals, [[0, 0, 1], [0, 0, -1]]]).astype(np.float32)
    tangents, bitangents = hemispheres.tangent_frames(torch.from_numpy(normals))
    expected = np.array([tangent_frame(normal) for normal in normals])
    np.testing.assert_allclose(tangents.numpy(), expected[:, :3], atol=1e-5)
    np.testing.assert_allclose(bitangents.numpy(), expected[:, 3:], atol=1e-5)


@pytest.mark.parametrize("count", [1, 20, 25])
def test_spread_voxels_are_those_of_the_live_path(count):
    for surface in SURFACES:
        few = keep_views(surface, np.arange(0, len(surface.view_centres), 2))
        chosen = spread_voxels(
            torch.from_numpy(few.positions)[None],
            torch.from_numpy(few.normals)[None],
            torch.from_numpy(few.observation_counts)[None],
            count,
        )
        assert chosen.shape == (1, count)
        expected = choose_voxels(few, count)
        assert sorted(set(chosen[0].tolist())) == expected.tolist()


def test_clusters_are_the_same_one_scene_at_a_time_and_all_in_step():
    generator = seeded(1)
    points = torch.rand((4, 60, 6), generator=generator, dtype=torch.float64)
    eligible = torch.rand((4, 60), generator=generator) < 0.8
    one_by_one = spread._one_by_one(points.numpy(), eligible.numpy(), 12)
    np.testing.assert_array_equal(one_by_one, spread._in_step(points, eligible, 12).numpy())


def test_voxels_are_counted_by_the_kernel_as_by_tensors():
    few = Augmentation(views=(5, 12), candidates=1000)
    drawer = SceneDrawer(PACKED, few)
    generator = seeded(3)
    scenes = torch.tensor([0, 1, 2, 1])
    kept = drawer._kept_views(scenes, generator)
    candidates, _ = drawer._candidates(scenes, generator)
    counts = drawer._counts(scenes, candidates, kept)
    seen = drawer._observations(scenes, candidates, kept)[2]
    np.testing.assert_array_equal(counts.numpy(), seen.sum(dim=2).numpy())
    assert 0 < counts.max() <= 12


def test_too_few_voxels_stand_in_twice_and_unseen_ones_never():
    counts = torch.tensor([[0, 7, 0, 9, 6]])
    generator = seeded(5)
    positions = torch.rand(1, 5, 3, generator=generator)
    chosen = spread_voxels(positions, positions, counts, 7)
    assert set(chosen[0].tolist()) == {1, 3, 4}
    some = random_voxels(torch.rand(1, 5, generator=generator), counts, 7)
    assert set(some[0].tolist()) == {1, 3, 4}


def test_random_voxels_prefer_those_seen_often_enough():
    counts = torch.tensor([[1, 7, 2, 9, 6, 0]])
    priority = torch.tensor([[0.1, 0.5, 0.2, 0.9, 0.4, 0.0]])
    assert random_voxels(priority, counts, 2)[0].tolist() == [4, 1]
    assert sorted(random_voxels(priority, counts, 5)[0].tolist()) == [0, 1, 2, 3, 4]


def test_observations_of_a_node_are_distinct_where_there_are_five():
    seen = torch.zeros(1, 2, 40, dtype=torch.bool)
    seen[0, 0, 3:33:5] = True  # six of them
    seen[0, 1, 7:10] = True
    places = choose_observations(seen, torch.rand(1, 2, 500, 5, generator=seeded(6)))
    assert seen.gather(2, places.flatten(2)).all()
    for node in places[0, 0].tolist():
        assert len(set(node)) == 5
    # Every observation is as likely as any other: 500 nodes take each of six about 417 times.
    frequency = torch.bincount(places[0, 0].flatten(), minlength=40)[seen[0, 0]]
    assert frequency.min() > 360
    assert frequency.max() < 470
