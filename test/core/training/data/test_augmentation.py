# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What is drawn changes what was seen, never what is true of it."""

import numpy as np
import pytest
import torch

from reflest_core.models.minibatch import PackedScenes
from reflest_core.models.recipe import Augmentation
from reflest_core.surface.selection import keep_views
from reflest_core.training.data.sample import Sample
from reflest_core.training.surface.drawn_scenes import SceneDrawer, about_vertical
from test.core.surfaces import sphere_surface

SURFACE = sphere_surface()
WARD = np.array([0.1, 0.2, 0.3, 0.05, 0.1])
SAMPLES = [Sample(sphere_surface(300, 40, seed), WARD) for seed in range(3)]
SAMPLES += [Sample(sphere_surface(60, 7, 9), WARD)]


def seeded(seed):
    return torch.Generator().manual_seed(seed)


def observations(surface, voxel):
    rows = slice(surface.offsets[voxel], surface.offsets[voxel + 1])
    return list(
        zip(surface.view_indices[rows].tolist(), surface.colours[rows].tolist(), strict=False)
    )


def drawn(augmentation, batch_size=16, voxels=10, seed=0):
    packed = PackedScenes.of(
        [sample.surface for sample in SAMPLES], np.stack([sample.ward for sample in SAMPLES])
    )
    return packed, SceneDrawer(packed, augmentation).draw(batch_size, voxels, seeded(seed))


def test_kept_views_are_the_only_ones_left_and_keep_all_they_saw():
    kept = keep_views(SURFACE, np.array([2, 5, 11]))
    for voxel in range(SURFACE.voxel_count):
        expected = [seen for seen in observations(SURFACE, voxel) if seen[0] in (2, 5, 11)]
        assert observations(kept, voxel) == expected


def test_drawn_places_hold_observations_of_their_own_voxel_and_scene():
    packed, scenes = drawn(Augmentation())
    for b, scene in enumerate(scenes.scenes.tolist()):
        assert (scenes.voxels[b] >= packed.first_voxel[scene]).all()
        assert (scenes.voxels[b] < packed.first_voxel[scene + 1]).all()
        for n, voxel in enumerate(scenes.voxels[b].tolist()):
            seen = scenes.seen[b, n]
            rows = scenes.rows[b, n][seen]
            assert (rows >= packed.offsets[voxel]).all()
            assert (rows < packed.offsets[voxel + 1]).all()
            expected = packed.view_of[rows] + packed.first_view[scene]
            assert torch.equal(scenes.views[b, n][seen], expected)


@pytest.mark.parametrize("spread", [True, False])
def test_views_and_voxels_stay_within_their_limits(spread):
    _, scenes = drawn(Augmentation(views=(5, 12), candidates=50, spread=spread), 64)
    counts = [
        len(views[seen].unique()) for views, seen in zip(scenes.views, scenes.seen, strict=True)
    ]
    assert max(counts) <= 12
    assert min(counts) >= 3  # of the five or more kept views, those that the voxels see
    assert len(set(counts)) > 3
    assert scenes.seen.any(dim=2).all()


def test_no_view_is_dropped_where_all_are_kept():
    packed, scenes = drawn(Augmentation(views=(1000, 1000), candidates=1000))
    assert torch.equal(scenes.seen.sum(dim=2), torch.diff(packed.offsets)[scenes.voxels])


def test_a_turn_is_about_the_vertical_and_keeps_lengths():
    rotation = about_vertical(torch.tensor([1.1]))[0]
    vector = torch.tensor([0.3, -0.4, 0.5])
    turned = rotation @ vector
    assert turned[2] == vector[2]
    assert turned.norm() == pytest.approx(float(vector.norm()), rel=1e-6)
    assert torch.atan2(turned[1], turned[0]) == pytest.approx(float(np.arctan2(-0.4, 0.3) + 1.1))


def test_channels_are_swapped_alike_everywhere_or_not_at_all():
    _, scenes = drawn(Augmentation(), 64)
    assert len({tuple(order) for order in scenes.channels.tolist()}) == 6
    colours = torch.arange(64 * 2 * 3.0).view(64, 2, 3)
    swapped = scenes.swap(colours)
    for b, order in enumerate(scenes.channels):
        assert torch.equal(swapped[b], colours[b][:, order])
    _, plain = drawn(Augmentation(channel_swap=False), 8)
    assert plain.channels.tolist() == [[0, 1, 2]] * 8


def test_equal_seeds_draw_the_same_and_others_do_not():
    _, first = drawn(Augmentation(), seed=4)
    _, again = drawn(Augmentation(), seed=4)
    _, other = drawn(Augmentation(), seed=5)
    for name in vars(first):
        assert torch.equal(getattr(first, name), getattr(again, name)), name
    assert not torch.equal(first.voxels, other.voxels)
