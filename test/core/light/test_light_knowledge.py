# Copyright 2026 The reflest developers
# SPDX-License-Identifier: Apache-2.0
"""How much is known of the light: shares with known values."""

import numpy as np
import pytest

from reflest_core.light.light_knowledge import UNKNOWN_LIGHT, light_knowledge
from reflest_core.light.light_map import SIZE, ObservedLight
from reflest_core.light.octahedral import octahedral_directions

DIRECTIONS = octahedral_directions(SIZE)
UP = np.array([[0.0, 0.0, 1.0]], np.float32)


def light(coverage, clipped, radiance=0.5):
    shape = (SIZE, SIZE)
    return ObservedLight(
        np.broadcast_to(np.float32(radiance), (*shape, 3)) * coverage[..., None],
        coverage.astype(np.float32),
        np.repeat(np.broadcast_to(clipped, shape)[..., None], 3, -1).astype(np.float32),
    )


def test_shares_are_weighted_by_the_cosine():
    """Within 30 degrees of the normal lies a quarter of the light of an even sky."""
    near = DIRECTIONS[..., 2] > np.cos(np.pi / 6)
    known = light_knowledge(light(near, 0.0), UP)
    assert known.seen == pytest.approx(0.25, abs=0.01)
    assert light_knowledge(light(near, 0.0), -UP).seen == pytest.approx(0.0, abs=1e-3)
    both = light_knowledge(light(near, 0.0), np.concatenate([UP, -UP]))
    assert both.seen == pytest.approx(known.seen / 2, rel=1e-3)


def test_clipping_is_a_share_of_the_light_not_of_directions():
    """A lamp on a quarter of the cosine that is nine times as bright gives three quarters."""
    near = DIRECTIONS[..., 2] > np.cos(np.pi / 6)
    known = light_knowledge(
        light(np.ones((SIZE, SIZE)), near, np.where(near, 0.9, 0.1)[..., None]), UP
    )
    assert known.seen == pytest.approx(1.0, abs=1e-4)
    assert known.clipped == pytest.approx(0.75, abs=0.02)


def test_no_light_is_no_knowledge():
    assert light_knowledge(None, UP) == UNKNOWN_LIGHT
    nothing = light(np.zeros((SIZE, SIZE)), 0.0)
    assert light_knowledge(nothing, UP) == UNKNOWN_LIGHT
