"""Augmentation changes what was seen, never what is true of it."""

import dataclasses

import numpy as np
import pytest

from reflest_core.features.hemisphere import hemisphere_images
from reflest_core.training.augmentation import (
    Augmentation,
    keep_views,
    keep_voxels,
    swap_channels,
    turn_world,
)
from reflest_core.training.sample import Sample
from test.core.surfaces import sphere_surface

SURFACE = sphere_surface()
WARD = np.array([0.1, 0.2, 0.3, 0.05, 0.1])


def observations(surface, voxel):
    rows = slice(surface.offsets[voxel], surface.offsets[voxel + 1])
    return list(
        zip(surface.view_indices[rows].tolist(), surface.colours[rows].tolist(), strict=False)
    )


def test_kept_voxels_keep_their_observations():
    voxels = np.array([7, 3, 150])
    kept = keep_voxels(SURFACE, voxels)
    assert kept.voxel_count == 3
    for new, old in enumerate(voxels):
        assert observations(kept, new) == observations(SURFACE, old)
        np.testing.assert_array_equal(kept.normals[new], SURFACE.normals[old])


def test_kept_views_are_the_only_ones_left_and_keep_all_they_saw():
    kept = keep_views(SURFACE, np.array([2, 5, 11]))
    for voxel in range(SURFACE.voxel_count):
        expected = [seen for seen in observations(SURFACE, voxel) if seen[0] in (2, 5, 11)]
        assert observations(kept, voxel) == expected


def test_turning_the_world_leaves_hemisphere_images_as_they_are():
    turned = turn_world(SURFACE, 1.1)
    assert not np.allclose(turned.positions, SURFACE.positions)
    voxels = np.arange(0, 300, 10)
    same = hemisphere_images(turned, voxels) == hemisphere_images(SURFACE, voxels)
    # A few pixels lie equally far from two observations, where rounding decides.
    assert same.mean() > 0.995


def test_swapping_channels_swaps_light_and_material_alike():
    swapped = swap_channels(Sample(SURFACE, WARD), np.array([2, 0, 1]))
    assert swapped.ward.tolist() == [0.3, 0.1, 0.2, 0.05, 0.1]
    np.testing.assert_array_equal(swapped.surface.colours, SURFACE.colours[:, [2, 0, 1]])
    np.testing.assert_array_equal(
        swapped.surface.view_background, SURFACE.view_background[:, [2, 0, 1]]
    )


def test_augmentation_keeps_within_its_limits_and_follows_its_seed():
    augmentation = Augmentation(views=(5, 12), voxels=50)
    draws = [augmentation.apply(Sample(SURFACE, WARD), np.random.default_rng(k)) for k in range(20)]
    for drawn in draws:
        assert drawn.surface.voxel_count == 50
        assert len(set(drawn.surface.view_indices.tolist())) <= 12
        assert sorted(drawn.ward[:3]) == pytest.approx([0.1, 0.2, 0.3])
    again = augmentation.apply(Sample(SURFACE, WARD), np.random.default_rng(3))
    for field in dataclasses.fields(again.surface):
        np.testing.assert_array_equal(
            getattr(again.surface, field.name), getattr(draws[3].surface, field.name)
        )
