# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Changes of colour with the view: their moments follow the gloss, and nothing else."""

import numpy as np
import pytest

from reflest_core.brdf import srgb
from reflest_core.inference.gloss.view_changes import view_changes
from reflest_core.surface.selection import keep_voxels
from test.core.surfaces import sphere_surface

LAMP = np.array([0.3, -0.2, 0.93])


def shiny(alpha, albedo=0.1, strength=0.3):
    """A ball under one lamp whose highlight is about as wide as ``alpha``."""

    def colour(towards, normal):
        mirrored = 2.0 * (towards @ normal) * normal - towards
        away = np.arccos(np.clip(mirrored @ LAMP / np.linalg.norm(LAMP), -1.0, 1.0))
        radiance = albedo + strength * np.exp(-((away / (2.0 * alpha)) ** 2))
        return np.full(3, np.round(255.0 * srgb.encode(radiance)))

    return sphere_surface(400, 60, 3, colour)


def test_rough_surfaces_blur_and_polished_ones_peak():
    surfaces = [shiny(alpha) for alpha in (0.05, 0.12, 0.3)]
    found = [view_changes(surface, np.arange(surface.voxel_count)) for surface in surfaces]
    assert found[0].blur > found[1].blur > found[2].blur
    assert found[0].peakedness > found[1].peakedness > found[2].peakedness


def test_more_gloss_changes_more_over_the_noise():
    weak, strong = (shiny(0.2, strength=strength) for strength in (0.02, 0.3))
    voxels = np.arange(weak.voxel_count)
    assert view_changes(strong, voxels).over_noise > view_changes(weak, voxels).over_noise + 1.0


def test_a_matte_surface_changes_by_nothing():
    found = view_changes(sphere_surface(colour=lambda *_: (90, 90, 90)), np.arange(300))
    assert found.square < 1e-9
    assert found.over_noise < 0.0


def test_the_order_of_voxels_does_not_matter():
    surface = shiny(0.1)
    order = np.random.default_rng(0).permutation(surface.voxel_count)
    one = view_changes(surface, np.arange(surface.voxel_count))
    other = view_changes(keep_voxels(surface, order), np.arange(surface.voxel_count))
    assert one.pairs == other.pairs
    assert one.blur == pytest.approx(other.blur, abs=1e-9)


@pytest.mark.parametrize("voxels", [0, 1])
def test_nothing_to_compare_has_no_changes(voxels):
    surface = sphere_surface(views=1)
    assert view_changes(surface, np.arange(voxels)) is None
