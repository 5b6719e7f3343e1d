# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""Colours that hold no material are told from those of matt, glossy and mirroring ones."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from reflest_core.fusion.scan import Scan
from reflest_core.fusion.settings import FusionSettings, RegionSettings
from reflest_core.surface.colour_problems import colour_problems
from test.core.fusion.analytic_scene import orbit_frames
from test.core.surfaces import patch_surface


def matt(towards, rng):
    return 90 + rng.normal(0, 3, (len(towards), 3))


def glossy(towards, rng):
    """A highlight of a lamp near the normal over a matt base, with a sensor's noise."""
    lobe = np.exp(-0.5 * ((towards - [0.97, 0.24, 0.0]) ** 2).sum(axis=1) / 0.1**2)
    return 60 + 170 * lobe[:, None] + rng.normal(0, 3, (len(towards), 3))


def mirror(towards, rng):
    """Only what is reflected: stripes of light and dark, smooth from place to place."""
    stripes = 0.5 + 0.5 * np.sin(12 * towards[:, 1] + 9 * towards[:, 2])
    return 10 + 220 * stripes[:, None] + rng.normal(0, 3, (len(towards), 3))


def black_object(towards, rng):
    return rng.integers(4, 9, (len(towards), 3))


@pytest.mark.parametrize("colour", [matt, glossy, mirror, black_object])
def test_colours_of_materials_are_no_problem(colour):
    assert not colour_problems(patch_surface(colour))


def all_black(towards, rng):
    return rng.integers(0, 3, (len(towards), 3))


def all_white(towards, rng):
    return rng.integers(254, 256, (len(towards), 3))


def red_overexposed(towards, rng):
    return np.where(rng.random(len(towards)) < 0.6, 255, 200)[:, None] * [1.0, 0.3, 0.2]


def noise(towards, rng):
    return rng.integers(0, 256, (len(towards), 3))


def dim_noise(towards, rng):
    return 30 + rng.normal(0, 12, (len(towards), 3))


@pytest.mark.parametrize(
    ("colour", "kind", "words"),
    [
        (all_black, "too_dark", "100% of the surface's observations are black"),
        (all_white, "overexposed", "100% of the surface's observations are overexposed"),
        (red_overexposed, "overexposed", "60% of the surface's"),
        (noise, "noise", "not shared by neighbours"),
        (dim_noise, "noise", "not shared by neighbours"),
    ],
)
def test_colours_of_none_are_named(colour, kind, words):
    problems = colour_problems(patch_surface(colour))
    assert words in getattr(problems, kind)
    assert sum(bool(value) for value in dataclasses.astuple(problems)) == 1


@pytest.mark.parametrize("voxel_size", [0.0035, 0.01])
def test_images_of_noise_are_noise_for_voxels_that_share_pixels_too(voxel_size):
    fusion = FusionSettings(voxel_size=voxel_size, max_depth=1.0, memory_budget_mb=64.0)
    scan = Scan(fusion, RegionSettings())
    rng = np.random.default_rng(4)
    for frame in orbit_frames(24):
        scan.fuse(dataclasses.replace(frame, rgb=rng.integers(0, 256, frame.rgb.shape, np.uint8)))
    assert colour_problems(scan.snapshot()).noise


def test_the_order_of_voxels_and_their_number_do_not_matter():
    for edge in (8, 60):
        surface = patch_surface(noise, edge=edge)
        assert colour_problems(surface).noise
    empty = dataclasses.replace(
        surface,
        positions=surface.positions[:0],
        normals=surface.normals[:0],
        offsets=surface.offsets[:1],
        colours=surface.colours[:0],
        view_indices=surface.view_indices[:0],
        keys=surface.keys[:0],
    )
    assert not colour_problems(empty)
