# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""What a network trained without a part can still see, and what not."""

import math

import numpy as np
import pytest
import torch

from reflest_core.training.light.ablation import PARTS, check_parts
from reflest_core.training.light.light_batches import whole_looks
from reflest_core.training.sample import TrainingError
from test.core.training.light.looks import made_looks

FITS = ["voxel_fit", "scene_fit", "channel_statistics", "statistics"]
SHARES = ["lobe_seen", "lobe_clipped", "diffuse_seen", "diffuse_clipped"]


@pytest.fixture(scope="module")
def looks():
    return made_looks(3, 0)


def without(looks, *parts):
    return whole_looks(looks, np.arange(3)), whole_looks(looks, np.arange(3), parts)


@pytest.mark.parametrize(
    ("part", "hidden"), [("fit", FITS), ("completion", FITS[2:]), ("shares", SHARES)]
)
def test_one_part_is_hidden_and_no_other(looks, part, hidden):
    whole, rest = without(looks, part)
    for name in whole:
        if name in hidden:
            assert not rest[name].any()
        elif (part, name) == ("shares", "zones"):
            assert not rest[name][..., 3:].any()
            torch.testing.assert_close(rest[name][..., :3], whole[name][..., :3])
        else:
            torch.testing.assert_close(rest[name], whole[name])


def test_without_light_colours_are_left_beside_the_mean_background(looks):
    whole, rest = without(looks, "light")
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


def test_uncertainty_is_no_input(looks):
    whole, rest = without(looks, "uncertainty")
    for name in whole:
        torch.testing.assert_close(rest[name], whole[name])


def test_a_part_that_there_is_not_is_refused_by_name():
    check_parts(tuple(PARTS))
    with pytest.raises(TrainingError, match="no part 'sense' to do without; choose of light"):
        check_parts(("fit", "sense"))
