# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a network trained without a part can still see, and what not."""

import dataclasses
import math

import numpy as np
import pytest
import torch

from reflest_core.inference.light import assumed_light
from reflest_core.inference.material import explain
from reflest_core.models.lightnet.scene_statistics import scene_statistics
from reflest_core.training.data.sample import TrainingError
from reflest_core.training.light.ablation import PARTS, check_parts
from reflest_core.training.light.batches import whole_scans
from test.core.surfaces import sphere_surface
from test.core.training.light.scans import made_scans

FITS = ["voxel_fit", "scene_fit", "channel_statistics", "statistics"]
FITS += ["found_albedo", "found_gloss", "gloss_evidence", "gloss_answers"]
SHARES = ["lobe_seen", "lobe_clipped", "diffuse_seen", "diffuse_clipped"]


@pytest.fixture(scope="module")
def scans():
    return made_scans(3, 0)


def without(scans, *parts):
    return whole_scans(scans, np.arange(3)), whole_scans(scans, np.arange(3), parts)


@pytest.mark.parametrize(("part", "hidden"), [("fit", FITS), ("shares", SHARES)])
def test_one_part_is_hidden_and_no_other(scans, part, hidden):
    whole, rest = without(scans, part)
    for name in whole:
        if name in hidden:
            assert not rest[name].any()
        elif (part, name) == ("shares", "zones"):
            assert not rest[name][..., 3:].any()
            torch.testing.assert_close(rest[name][..., :3], whole[name][..., :3])
        else:
            torch.testing.assert_close(rest[name], whole[name])


def test_without_light_colours_are_left_beside_the_mean_background(scans):
    whole, rest = without(scans, "light")
    polar = (torch.arange(8) + 0.5) * math.pi / 8
    weight = whole["zones"][..., 3] * polar.sin()
    background = (whole["zones"][..., :3] * weight[..., None]).sum(1)
    background = (background / weight.sum(1, keepdim=True))[:, None]
    colour = whole["apparent"] * whole["diffuse_light"][:, :, None]
    torch.testing.assert_close(rest["apparent"] * background[:, None], colour)
    torch.testing.assert_close(rest["diffuse_light"], background.expand(3, 48, 3))
    torch.testing.assert_close(rest["zones"][..., :3], background.expand(3, 8, 3))
    for name in [*FITS, *SHARES, "lobe"]:
        assert not rest[name].any()


def test_uncertainty_is_no_input(scans):
    whole, rest = without(scans, "uncertainty")
    for name in whole:
        torch.testing.assert_close(rest[name], whole[name])


def test_a_part_that_there_is_not_is_refused_by_name():
    check_parts(tuple(PARTS))
    with pytest.raises(TrainingError, match="no part 'sense' to do without; choose of light"):
        check_parts(("fit", "sense"))


def test_without_completion_just_what_comes_with_it_is_hidden(scans):
    """Those numbers that differ when only the fits of light and of the material in it do."""
    surface = sphere_surface(voxels=300, views=40)
    found = explain(surface, assumed_light(surface))
    misfits = np.linspace(0.1, 0.2, 8, dtype=np.float32)
    others = [
        dataclasses.replace(
            found,
            inferred=tuple(map(_changed, found.inferred)),
            material=dataclasses.replace(
                _changed(found.material), misfit=misfit, weight=misfits / misfits.sum()
            ),
        )
        for misfit in (misfits, misfits[::-1])  # that of the best roughness is always 0
    ]
    before = scene_statistics(found)
    changed = [scene_statistics(other) for other in others]
    whole, rest = without(scans, "completion")
    for name, differs in (
        (
            "channel_statistics",
            [(one.of_channels != before.of_channels).any(axis=0) for one in changed],
        ),
        ("statistics", [one.of_all != before.of_all for one in changed]),
        ("found_albedo", [(one.albedos != found.albedos).any(axis=0) for one in others]),
        ("found_gloss", [one.glosses != found.glosses for one in others]),
    ):
        is_hidden = (whole[name] != rest[name]).flatten(0, -2).any(dim=0).numpy()
        np.testing.assert_array_equal(is_hidden, np.any(differs, axis=0))
        assert not rest[name][..., is_hidden].any()
    for name in whole.keys() - {"channel_statistics", "statistics", "found_albedo"}:
        torch.testing.assert_close(rest[name], whole[name])


def _changed(fit):
    rng = np.random.default_rng(1)
    arrays = {field.name: getattr(fit, field.name) for field in dataclasses.fields(fit)}
    return type(fit)(
        **{
            name: (array * rng.uniform(0.6, 0.9, array.shape) + 0.01).astype(np.float32)
            for name, array in arrays.items()
        }
    )
